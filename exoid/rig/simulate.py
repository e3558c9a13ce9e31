"""Simulation of a rig: the plant in small steps, controller and log at lower rates."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.actuators import Actuators
from exoid.actuators.actuators import DRIVE_CHANNELS
from exoid.errors import BadArgumentError, ExoidError
from exoid.leg.torso import TorsoMotion
from exoid.signals import Recording
from exoid.tools.tables import DataTable, to_text, value_range

from .actuators import Actuator, Drive
from .controllers import Controller, Reference, Target, WornController
from .plant import Plant
from .sensors import Sensors
from .stepper import PlanarStepper, Step, Stepper
from .wearer import Wearer
from .worn_stepper import TOLERANCE, WornStepper

DIVERGED_SPEED = 1e4
"""Speed from which a joint counts as diverged [rad/s]."""


class Rates(NamedTuple):
    """Rates of controller and log; each period must be a multiple of the plant's step.

    Attributes:
        control: Rate of the controller [Hz]; inf for an analogue one, or one so fast that its torque follows the motion
            continuously. Its command is evaluated at the middle of each step, so that the scheme stays of second order.
        log: Rate of the log [Hz]; a sample of both has the same readings.
        step: Step of the plant [s].
    """

    control: float = 500.0
    log: float = 50.0
    step: float = 5e-4

    def steps(self) -> tuple[int, int]:
        """Count the steps of the plant in each period.

        Returns:
            Steps in a period of the controller, 0 for a continuous one, and of the log.

        Raises:
            ExoidError: A rate or the step is not positive, or a period is not a multiple of the step.
        """
        if not (self.control > 0.0 and all(np.isfinite(x) and x > 0.0 for x in self[1:])):
            raise BadArgumentError(f"rates and step must be positive: {self}", remedy="give them in Hz, Hz and s")
        counts = [1.0 / (rate * self.step) for rate in (self.control, self.log)]
        whole = [round(count) for count in counts]
        wrong = [abs(count - k) > 1e-6 * k or (k < 1 and count > 0.0) for count, k in zip(counts, whole, strict=True)]
        if any(wrong):
            raise BadArgumentError(
                f"rates of {self.control:g} and {self.log:g} Hz do not fit a step of {self.step:g} s",
                remedy="choose periods that are whole multiples of the step",
            )
        return whole[0], whole[1]


class Energy(NamedTuple):
    """Energy balance of a run [J], (B,) each: work = gain + dissipated, up to the integration error.

    Attributes:
        work: Work of the actuators, and of the muscles of wearers.
        gain: Gain of mechanical energy, springs, rotors and limbs of wearers included.
        dissipated: Energy that friction, end stops and cuffs dissipate.
        turnover: ∫ |power| dt of actuators and muscles or of what dissipates, the larger of the two; the scale of
            errors.
    """

    work: FloatArray
    gain: FloatArray
    dissipated: FloatArray
    turnover: FloatArray

    @property
    def relative_error(self) -> FloatArray:
        """Residual of the balance over the turnover, (B,); zero where nothing moved."""
        error = np.abs(self.work - self.gain - self.dissipated)
        return np.asarray(error / np.where(self.turnover > 0.0, self.turnover, np.inf))

    def __repr__(self) -> str:
        """Write the range of each part over the rigs."""
        parts = zip(("work", "gain", "dissipated"), (self.work, self.gain, self.dissipated), strict=True)
        text = ", ".join(f"{name} {value_range(values)} J" for name, values in parts)
        return f"Energy({len(self.work)} rigs: {text}; relative error up to {self.relative_error.max():.1g})"


@dataclass(frozen=True, eq=False, repr=False)
class Run:
    """True motion and torque of B rigs, and the readings of their sensors; K log samples.

    Attributes:
        plant: Simulated plant.
        time: Time [s], (K,).
        q: True angles [rad], (K, n, B).
        v: True velocities [rad/s], (K, n, B).
        tau: True actuator torques at the sample [N·m], (K, n, B).
        q_measured: Angle readings [rad], (K, n, B).
        v_measured: Velocity readings [rad/s], (K, n, B).
        tau_measured: Torque readings [N·m], (K, n, B).
        target: Reference angles [rad], (K, n, B).
        energy: Energy balance.
        interaction: True torque of the wearers on the legs [N·m], (K, n, B); None without wearer.
        limb_q: True angles of the wearers' limbs [rad], (K, n, B); None without wearer.
    """

    plant: Plant
    time: FloatArray
    q: FloatArray
    v: FloatArray
    tau: FloatArray
    q_measured: FloatArray
    v_measured: FloatArray
    tau_measured: FloatArray
    target: FloatArray
    energy: Energy
    interaction: FloatArray | None = None
    limb_q: FloatArray | None = None

    def __repr__(self) -> str:
        """Name the plant and the size of the log."""
        return f"Run({self.plant.description}: {self._size})"

    def __str__(self) -> str:
        """Print as a table: range of motion, tracking error and torque over all rigs, one line a joint."""
        degrees, error = np.rad2deg(self.q), np.rad2deg(self.target - self.q)
        rows = [
            (
                name,
                value_range((degrees[:, joint].min(), degrees[:, joint].max())),
                f"{np.abs(self.v[:, joint]).max():.3g}",
                f"{np.abs(error[:, joint]).max():.3g}",
                f"{np.sqrt(np.mean(error[:, joint] ** 2)):.3g}",
                f"{np.abs(self.tau[:, joint]).max():.3g}",
            )
            for joint, name in enumerate(self.plant.leg.joint_names)
        ]
        headers = (
            "joint",
            "angle [deg]",
            "max speed [rad/s]",
            "max error [deg]",
            "rms error [deg]",
            "max torque [N·m]",
        )
        table = DataTable(f"Run of {self.plant.description}: {self._size}", headers, rows)
        return to_text(table, f"energy balance: relative error up to {self.energy.relative_error.max():.1g}")

    @property
    def _size(self) -> str:
        rate = 1.0 / (self.time[1] - self.time[0]) if len(self.time) > 1 else 0.0
        return f"{len(self.time)} samples at {rate:.4g} Hz, {self.time[-1]:.4g} s"

    def recording(
        self,
        rig: int = 0,
        *,
        velocity: bool = False,
        joint_names: Sequence[str] | None = None,
        actuators: Actuators | None = None,
    ) -> Recording:
        """Return the readings of one rig as a log.

        Drives measure what makes the torque readings at the true angles and velocities: their noise is that of the
        torque sensor.

        Args:
            rig: Index of the rig.
            velocity: Whether the log contains the measured velocity.
            joint_names: Names of the joints; None for those of the plant's leg.
            actuators: Drives whose currents, forces or motor angles are logged in place of the torques of their joints;
                None for torques.

        Returns:
            Log of the rig with its torso tilt.

        Raises:
            ExoidError: There is no such rig, the run is too short for a recording, or a drive cannot make the torque.
        """
        if not -self.plant.count <= rig < self.plant.count:
            raise BadArgumentError(f"no rig {rig} among {self.plant.count}", remedy="count from 0")
        names = self.plant.leg.joint_names
        log = Recording(
            time=self.time,
            q=self.q_measured[..., rig],
            v=self.v_measured[..., rig] if velocity else None,
            tau=self.tau_measured[..., rig],
            joint_names=tuple(joint_names or names),
            torso=TorsoMotion(pitch=float(self.plant.pitch[rig])) if self.plant.pitch[rig] else None,
        )
        if actuators is None:
            return log
        true = replace(log, q=self.q[..., rig], v=self.v[..., rig], joint_names=names)
        measured = actuators.readings(true)
        return replace(log, tau=measured.tau, **{name: getattr(measured, name) for name in DRIVE_CHANNELS})


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
    stepper: Callable[[Plant, FloatArray, FloatArray, float], Stepper] = PlanarStepper,
    wearer: Wearer | None = None,
    progress: Callable[[float], None] | None = None,
) -> Run:
    """Let B rigs follow a motion.

    Args:
        plant: B rigs.
        reference: Motion to follow.
        controller: Controller, whose command is held between its samples. A continuous one (see :class:`Rates`) reads
            true angles and velocities.
        actuator: Actuator of each joint, initially in state zero.
        duration: Duration [s].
        start: Initial angles [rad], (n, B) or (n, 1); the rigs then start at rest. None for angles and velocities of
            the reference.
        sensors: Sensors; None for exact readings.
        rates: Rates of controller and log, and step of the plant.
        seed: Seed or generator of the sensor noise.
        stepper: Integrator: :class:`PlanarStepper`, :class:`SmoothStepper`, or :class:`PinocchioStepper` for a single
            rig of any leg.
        wearer: Wearer of every rig, whose limb starts with the motion of the leg; None for nobody. A
            :class:`WornController` receives the torque of the wearer.
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
    dt, count = rates.step, _step_count(duration, rates.step)
    leg = stepper(plant, *_start(plant, reference, start), dt)
    limb = None if wearer is None else WornStepper(leg, wearer, count)
    rig = limb or leg
    state, command, torque = np.zeros((3, plant.n, plant.count))
    past: deque[tuple[FloatArray, ...]] = deque(maxlen=sensors.delay * every_control + 1)
    samples: list[tuple[FloatArray, ...]] = []
    before, begin, exchanged = rig.v, rig.energy(), np.zeros((3, plant.count))
    feels = isinstance(controller, WornController) and limb is not None
    law: Callable[..., FloatArray] = controller.command_worn if feels else controller.command  # type: ignore[attr-defined]

    def commanded(target: Target, *reading: FloatArray) -> FloatArray:
        return _broadcast(law(target, *reading), plant, "command of the controller")

    with np.errstate(over="ignore", invalid="ignore"):  # overflow of a diverging run, which raises an error below
        for k in range(count + 1):
            past.append((torque, rig.q, rig.v, *((limb.limb.q, limb.limb.v) if limb else ())))
            logs, controls = k % every_log == 0, every_control and k % every_control == 0
            if controls or logs:
                _refuse_divergence(rig.v, k * dt)
                target, (tau, *motion) = reference.at(k * dt), past[0]
                reading = sensors.angle(motion[0], rng), sensors.velocity(motion[1], rng)
                felt = (sensors.interaction(limb.interaction(*motion), rng),) if limb and feels and controls else ()
            if controls:
                command = commanded(target, *reading, *felt)
            if logs:
                if not every_control:
                    tau = torque = actuator.torque(state, commanded(target, rig.q, rig.v))
                worn = (limb.interaction(*past[-1][1:]), limb.limb.q) if limb else ()
                targets = _broadcast(target.q, plant, "target")
                samples.append((rig.q, rig.v, torque, *reading, sensors.torque(tau, rng), targets, *worn))
                if progress is not None:
                    progress(k / count)
            if k == count:
                break
            if not every_control:
                ahead = rig.v + 0.5 * (rig.v - before)
                command = commanded(reference.at((k + 0.5) * dt), rig.q + 0.5 * dt * rig.v, ahead)
            drive, before = actuator.drive(state, command, dt), rig.v
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


def _exchanged(plant: Plant, drive: Drive, step: Step, dt: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Work, dissipated energy and turnover of one step [J], (B,) each."""
    travelled = dt * step.mean_velocity
    work = (drive.torque - drive.damping * step.mean_velocity) * travelled
    lost = (step.friction_impulse + plant.viscous * travelled) * step.mean_velocity
    return work.sum(axis=0), lost.sum(axis=0), np.abs(work).sum(axis=0)


def _step_count(duration: float, step: float) -> int:
    count = duration / step
    if not (np.isfinite(count) and count >= 0.5):
        raise BadArgumentError(f"a run of {duration:g} s", remedy=f"give a duration of at least {step:g} s")
    return round(count)


def _start(plant: Plant, reference: Reference, start: ArrayLike | None) -> tuple[FloatArray, FloatArray]:
    """Initial angles and velocities."""
    first = reference.at(0.0)
    q = _broadcast(first.q if start is None else start, plant, "start")
    v = _broadcast(first.v if start is None else 0.0, plant, "velocity of the reference")
    if not (np.isfinite(q).all() and np.isfinite(v).all()):
        raise BadArgumentError("the start is not finite", remedy="give angles in rad")
    beyond = (q < plant.lower - TOLERANCE) | (q > plant.upper + TOLERANCE)
    if beyond.any():
        joint, which = np.argwhere(beyond)[0]
        raise BadArgumentError(
            f"{plant.leg.joint_names[joint]} starts at {q[joint, which]:.4g} rad in rig {which}, beyond its end stops "
            f"at {plant.lower[joint, which]:.4g} and {plant.upper[joint, which]:.4g} rad",
            joints=(plant.leg.joint_names[joint],),
            remedy="start between them, or build the plant with end_stops=False",
        )
    return q, v


def _broadcast(values: ArrayLike, plant: Plant, name: str) -> FloatArray:
    """Broadcast values over joints and rigs."""
    try:
        return np.broadcast_to(np.asarray(values, dtype=np.float64), (plant.n, plant.count))
    except (TypeError, ValueError) as error:
        raise BadArgumentError(
            f"{name}: shape {np.shape(values)} for {plant.n} joints of {plant.count} rigs",
            remedy=f"give ({plant.n}, {plant.count}) or ({plant.n}, 1) numbers",
        ) from error


def _refuse_divergence(v: FloatArray, time: float) -> None:
    if not (np.abs(v) < DIVERGED_SPEED).all():
        raise ExoidError(
            f"the rig diverged before {time:.3g} s",
            remedy="lower the gain, add damping or leakage, or shorten the step; check gains and model",
        )
