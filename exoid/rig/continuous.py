"""Loops without sampling: a controller so fast, or analogue, that its torque follows the motion at every moment."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .actuators import Actuator
from .controllers import Controller, Reference
from .simulate import FASTEST
from .stepper import Stepper


class Followed(NamedTuple):
    """What B rigs did, (K, n, B) each.

    Attributes:
        q: Angles [rad].
        v: Velocities [rad/s].
        tau: Actuator torques [N·m].
    """

    q: FloatArray
    v: FloatArray
    tau: FloatArray


def follow(
    rig: Stepper, reference: Reference, controller: Controller, actuator: Actuator, start: float, every: int, count: int
) -> Followed:
    """Let B rigs follow a motion, the command of each step being that of its middle, which makes it second order.

    Args:
        rig: Where it is at the start.
        reference: What to follow.
        controller: Sees the true angles and velocities.
        actuator: Between command and torque.
        start: Time of the first sample [s].
        every: Steps from one sample to the next.
        count: Of samples K.

    Raises:
        ExoidError: The run diverges.
    """
    dt, shape = rig.dt, (rig.plant.n, rig.plant.count)
    state, before, samples = np.zeros(shape), rig.v, []
    with np.errstate(over="ignore", invalid="ignore"):  # of a run that diverges, which is refused below
        for k in range(every * (count - 1) + 1):
            time = start + k * dt
            if k % every == 0:
                if not (np.abs(rig.v) < FASTEST).all():
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
    return Followed(*(np.array(x) for x in zip(*samples, strict=True)))
