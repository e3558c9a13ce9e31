"""Loops without sampling: an analogue controller, or one so fast that its torque follows the motion continuously."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .actuators import Actuator
from .controllers import Controller, Reference
from .simulate import DIVERGED_SPEED
from .stepper import Stepper


class ContinuousRun(NamedTuple):
    """True motion and torque of B rigs at K samples, (K, n, B) each."""

    q: FloatArray  # angles [rad]
    v: FloatArray  # velocities [rad/s]
    tau: FloatArray  # actuator torques [N·m]


def follow(
    rig: Stepper, reference: Reference, controller: Controller, actuator: Actuator, start: float, every: int, count: int
) -> ContinuousRun:
    """Let B rigs follow a motion under a continuous controller."""
    # The command of each step is evaluated at the middle of the step, which makes the scheme of second order.
    dt, shape = rig.dt, (rig.plant.n, rig.plant.count)
    state, before, samples = np.zeros(shape), rig.v, []
    with np.errstate(over="ignore", invalid="ignore"):  # overflow of a diverging run, which raises an error below
        for k in range(every * (count - 1) + 1):
            time = start + k * dt
            if k % every == 0:
                if not (np.abs(rig.v) < DIVERGED_SPEED).all():
                    raise ExoidError(
                        f"the loop diverged before {time:.3g} s", remedy="shorten the step, or check gains and model"
                    )
                command = controller.command(reference.at(time), rig.q, rig.v)
                samples.append((rig.q, rig.v, actuator.torque(state, np.broadcast_to(command, shape))))
            ahead = rig.v + 0.5 * (rig.v - before)
            command = controller.command(reference.at(time + 0.5 * dt), rig.q + 0.5 * dt * rig.v, ahead)
            command, before = np.broadcast_to(command, shape), rig.v
            drive = actuator.drive(state, command, dt)
            step = rig.step(drive.torque, drive.damping)
            state = actuator.advance(state, command, step.mean_velocity, dt)
    return ContinuousRun(*(np.array(x) for x in zip(*samples, strict=True)))
