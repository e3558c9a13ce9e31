"""Simulation of a rig: the plant in small steps, controller and log at lower rates."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError
from exoid.tools.numbers import ROUNDED
from exoid.torques.position_units import position_units

from .actuators import Actuator, StepTorque
from .controllers import Controller, Reference
from .plant import Plant
from .run import Energy, Run
from .sensors import Sensors, read_angle, read_torque, read_velocity
from .stepper import Step, Stepper
from .wearer import Wearer
from .worn_stepper import WornStepper

DIVERGED_SPEED = 1e4  # speed from which a joint counts as diverged [rad/s]


class Rates(NamedTuple):
    """Rates of controller and log; each period must be a multiple of the plant's step.

    Attributes:
        control: Rate of the controller [Hz].
        log: Rate of the log [Hz]; a sample of both has the same readings.
        step: Step of the plant [s].
    """

    control: float = 500.0
    log: float = 50.0
    step: float = 5e-4

    def steps(self) -> tuple[int, int]:
        """Count the steps of the plant in each period.

        Returns:
            Steps in a period of the controller, and of the log.

        Raises:
            ExoidError: A rate or the step is not positive, or a period is not a multiple of the step.
        """
        if not all(np.isfinite(x) and x > 0.0 for x in self):
            raise BadArgumentError(f"rates and step must be positive: {self}", remedy="give them in Hz, Hz and s")
        counts = [1.0 / (rate * self.step) for rate in (self.control, self.log)]
        whole = [round(count) for count in counts]
        if any(abs(count - k) > 1e-6 * k or k < 1 for count, k in zip(counts, whole, strict=True)):
            what = f"rates of {self.control:g} and {self.log:g} Hz do not fit a step of {self.step:g} s"
            raise BadArgumentError(what, remedy="choose periods that are whole multiples of the step")
        return whole[0], whole[1]


def simulate(
    plant: Plant,
    reference: Reference,
    controller: Controller,
    actuator: Actuator,
    duration: float,
    *,
    start: ArrayLike | None = None,
    sensors: Sensors | None = None,
    rates: Rates | None = None,
    seed: int | np.random.Generator = 0,
    stepper: Callable[[Plant, FloatArray, FloatArray, float], Stepper] = Stepper,
    wearer: Wearer | None = None,
    progress: Callable[[float], None] | None = None,
) -> Run:
    """Let B rigs follow a motion.

    Args:
        plant: B rigs.
        reference: Motion to follow.
        controller: Controller, whose command is held between its samples.
        actuator: Actuator of each joint, initially in state zero.
        duration: Duration [s].
        start: Initial angles [rad], (n, B) or (n, 1), of one rig (n,); the rigs then start at rest. None for
            angles and velocities of the reference.
        sensors: Sensors; None for exact readings.
        rates: Rates of controller and log, and step of the plant.
        seed: Seed or generator of the sensor noise.
        stepper: Integrator, :class:`Stepper` or one derived from it.
        wearer: Wearer of every rig, whose limb starts with the motion of the leg; None for nobody.
        progress: Function that receives the completed share of the run, 0 to 1.

    Returns:
        True and measured motion and torque at the rate of the log.

    Raises:
        ExoidError: Rates or shapes do not fit, the start is not finite or beyond an end stop, the wearer does not fit
            (see :class:`exoid.rig.Wearer`), or the run diverges.

    Example:
        >>> import exoid
        >>> from exoid.experiments import Hold
        >>> from exoid.rig import IdealTorque, ProportionalDerivative
        >>> plant, pose = Plant.build(exoid.load_leg("cuhk"), {"c0_hip": 1.5}), Hold(np.array([[0.5], [0.5]]))
        >>> simulate(plant, pose, ProportionalDerivative(200.0, 20.0), IdealTorque(), 1.0)
        Run(1 × cuhk.urdf (left_hip, left_knee): 51 samples at 50 Hz, 1 s)
    """
    rates, sensors, rng = rates or Rates(), sensors or Sensors(encoder_counts=np.inf), np.random.default_rng(seed)
    every_control, every_log = rates.steps()
    dt = rates.step
    if not (np.isfinite(duration) and duration >= 0.5 * dt):
        raise BadArgumentError(f"a run of {duration:g} s", remedy=f"give a duration of at least {dt:g} s")
    count = round(duration / dt)
    leg = stepper(plant, *_start(plant, reference, start), dt)
    limb = None if wearer is None else WornStepper(leg, wearer, count)
    rig = limb or leg
    state, command, torque = np.zeros((3, plant.n, plant.count))
    past: deque[tuple[FloatArray, ...]] = deque(maxlen=sensors.delay * every_control + 1)
    samples: list[tuple[FloatArray, ...]] = []
    begin, exchanged = rig.energy(), np.zeros((3, plant.count))
    with np.errstate(over="ignore", invalid="ignore"):  # overflow of a diverging run, which raises an error below
        for k in range(count + 1):
            past.append((torque, rig.q, rig.v, *((limb.limb.q, limb.limb.v) if limb else ())))
            logs, controls = k % every_log == 0, k % every_control == 0
            if controls or logs:
                if not (np.abs(rig.v) < DIVERGED_SPEED).all():
                    raise BadArgumentError(
                        f"the rig diverged before {k * dt:.3g} s",
                        remedy="lower the gain, add damping or leakage, or shorten the step; check gains and model",
                    )
                target, (tau, *motion) = reference.at(k * dt), past[0]
                reading = read_angle(sensors, motion[0], rng), read_velocity(sensors, motion[1], rng)
            if controls:
                felt = (limb.interaction(*motion),) if limb else ()
                command = _broadcast(controller.command(target, *reading, *felt), plant, "command of the controller")
            if logs:
                worn = (limb.interaction(*past[-1][1:]), limb.limb.q) if limb else ()
                targets = _broadcast(target.q, plant, "target")
                samples.append((rig.q, rig.v, torque, *reading, read_torque(sensors, tau, rng), targets, *worn))
                if progress is not None:
                    progress(k / count)
            if k == count:
                break
            drive = actuator.drive(state, command, dt)
            step = rig.step(drive.torque, drive.damping)
            state = actuator.advance(state, command, step.mean_velocity, dt)
            torque = actuator.torque(state, command)
            exchanged += _exchanged(plant, drive, step, dt)
    work, dissipated, turnover = exchanged + (limb.exchange if limb else 0.0)
    energy = Energy(work, rig.energy() - begin, dissipated, np.maximum(turnover, dissipated))
    time = every_log * dt * np.arange(len(samples), dtype=np.float64)
    q, v, tau, q_measured, v_measured, tau_measured, targets, *of_wearer = (
        np.array(x) for x in zip(*samples, strict=True)
    )
    return Run(plant, time, q, v, tau, q_measured, v_measured, tau_measured, targets, energy, *of_wearer)


def _exchanged(plant: Plant, drive: StepTorque, step: Step, dt: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Work, dissipated energy and turnover of one step [J], (B,) each."""
    travelled = dt * step.mean_velocity
    work = (drive.torque - drive.damping * step.mean_velocity) * travelled
    lost = (step.friction_impulse + plant.viscous * travelled) * step.mean_velocity
    return work.sum(axis=0), lost.sum(axis=0), np.abs(work).sum(axis=0)


def _start(plant: Plant, reference: Reference, start: ArrayLike | None) -> tuple[FloatArray, FloatArray]:
    """Initial angles and velocities."""
    first = reference.at(0.0)
    q = _broadcast(first.q if start is None else start, plant, "start")
    v = _broadcast(first.v if start is None else 0.0, plant, "velocity of the reference")
    if not (np.isfinite(q).all() and np.isfinite(v).all()):
        raise BadArgumentError("the start is not finite", remedy="give angles in rad")
    beyond = (q < plant.lower - ROUNDED) | (q > plant.upper + ROUNDED)
    if beyond.any():
        joint, which = np.argwhere(beyond)[0]
        name, unit = plant.leg.joint_names[joint], position_units(plant.leg)[joint].rad
        raise BadArgumentError(
            f"{name} starts at {q[joint, which]:.4g} {unit} in rig {which}, beyond its end stops "
            f"at {plant.lower[joint, which]:.4g} and {plant.upper[joint, which]:.4g} {unit}",
            joints=(name,),
            remedy="start between them, or build the plant with end_stops=False",
        )
    return q, v


def _broadcast(values: ArrayLike, plant: Plant, name: str) -> FloatArray:
    """Broadcast values over joints and rigs."""
    try:
        given = np.asarray(values, dtype=np.float64)
        each = given[:, None] if plant.count == 1 and given.ndim == 1 else given
        return np.broadcast_to(each, (plant.n, plant.count))
    except (TypeError, ValueError) as error:
        raise BadArgumentError(
            f"{name}: shape {np.shape(values)} for {plant.n} joints of {plant.count} rigs",
            remedy=f"give one row a joint and one column a rig, ({plant.n}, {plant.count})",
        ) from error
