"""Running a rig: plant in small steps, controller and log at rates of their own."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError
from exoid.signals import Recording
from exoid.torso import TorsoMotion

from .actuators import Actuator
from .controllers import Controller, Reference
from .plant import Plant
from .sensors import Sensors
from .stepper import PlanarStepper, Step, Stepper

STEP = 5e-4
"""Of the plant [s]."""

FASTEST = 1e4
"""A joint faster than this [rad/s] has diverged."""

STOP_TOLERANCE = 1e-9
"""Of a start at an end stop [rad]."""


class Rates(NamedTuple):
    """How often what happens; each period must be a multiple of the plant's step.

    Attributes:
        control: Of the controller [Hz].
        log: Of the log [Hz], which sees what the controller sees.
        step: Of the plant [s].
    """

    control: float = 500.0
    log: float = 50.0
    step: float = STEP

    def steps(self) -> tuple[int, int]:
        """Steps of the plant a period of the controller and of the log.

        Raises:
            ExoidError: A rate or the step is not positive, or a period is not a multiple of the step.
        """
        if not all(np.isfinite(x) and x > 0.0 for x in self):
            raise ExoidError(f"rates and step must be positive: {self}", remedy="give them in Hz, Hz and s")
        counts = [1.0 / (rate * self.step) for rate in (self.control, self.log)]
        whole = [round(count) for count in counts]
        if min(whole) < 1 or any(abs(count - k) > 1e-6 * k for count, k in zip(counts, whole, strict=True)):
            raise ExoidError(
                f"rates of {self.control:g} and {self.log:g} Hz do not fit a step of {self.step:g} s",
                remedy="choose periods that are whole multiples of the step",
            )
        return whole[0], whole[1]


class Energy(NamedTuple):
    """Where energy went during a run [J], (B,) each: work = gain + dissipated, up to the scheme's error.

    Attributes:
        work: Done by the actuators.
        gain: Of mechanical energy, springs and rotors included.
        dissipated: By friction and end stops.
        turnover: ∫ |power| dt of the actuators and of friction, whichever is larger, to compare errors with.
    """

    work: FloatArray
    gain: FloatArray
    dissipated: FloatArray
    turnover: FloatArray

    @property
    def relative_error(self) -> FloatArray:
        """Energy that came from nowhere, over the turnover, (B,); zero where nothing moved."""
        error = np.abs(self.work - self.gain - self.dissipated)
        return np.asarray(error / np.where(self.turnover > 0.0, self.turnover, np.inf))


@dataclass(frozen=True, eq=False)
class Run:
    """What B rigs did, and what their sensors said; K log samples.

    Attributes:
        plant: The truth.
        time: [s], (K,).
        q: True angles [rad], (K, n, B).
        v: True velocities [rad/s], (K, n, B).
        tau: True actuator torques at that moment [N·m], (K, n, B).
        q_measured: (K, n, B).
        v_measured: (K, n, B).
        tau_measured: (K, n, B).
        target: Angles to be followed [rad], (K, n, B).
        energy: The audit.
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

    def recording(self, rig: int = 0, *, velocity: bool = False, joint_names: Sequence[str] | None = None) -> Recording:
        """Log of one rig, as its sensors saw it.

        Args:
            rig: Which.
            velocity: Whether the log contains the measured velocity.
            joint_names: Names of the joints; None for those of the plant's leg.

        Raises:
            ExoidError: There is no such rig, or the run is too short for a recording.
        """
        if not -self.plant.count <= rig < self.plant.count:
            raise ExoidError(f"no rig {rig} among {self.plant.count}", remedy="count from 0")
        return Recording(
            time=self.time,
            q=self.q_measured[..., rig],
            v=self.v_measured[..., rig] if velocity else None,
            tau=self.tau_measured[..., rig],
            joint_names=tuple(joint_names or self.plant.leg.joint_names),
            torso=TorsoMotion(pitch=float(self.plant.pitch[rig])) if self.plant.pitch[rig] else None,
        )


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
    progress: Callable[[float], None] | None = None,
) -> Run:
    """Let B rigs follow a motion.

    Args:
        plant: The truth.
        reference: What to follow.
        controller: Sampled at its own rate, its command held in between.
        actuator: Between command and torque; starts from rest.
        duration: [s].
        start: Angles at the beginning [rad], (n, B) or (n, 1); None for the reference's.
        sensors: None for exact ones.
        rates: Of controller, log and plant.
        seed: Of the sensor noise.
        stepper: :class:`PlanarStepper`, or :class:`PinocchioStepper` for a single rig of any leg.
        progress: Told the share that is done, now and then.

    Returns:
        True and measured motion and torque at the rate of the log.

    Raises:
        ExoidError: Rates or shapes do not fit, the start is not finite or beyond an end stop, or the run diverges.
    """
    rates, sensors, rng = rates or Rates(), sensors or Sensors(encoder_counts=np.inf), np.random.default_rng(seed)
    every_control, every_log = rates.steps()
    dt, count = rates.step, _step_count(duration, rates)
    rig = stepper(plant, *_start(plant, reference, start), dt)
    state, command, torque = np.zeros((3, plant.n, plant.count))
    past: deque[tuple[FloatArray, FloatArray, FloatArray]] = deque(maxlen=sensors.delay * every_control + 1)
    log, audit = _Log(), _Audit(plant, rig.energy())
    with np.errstate(over="ignore", invalid="ignore"):  # of a run that diverges, which is refused below
        for k in range(count + 1):
            past.append((rig.q, rig.v, torque))
            controls, logs = k % every_control == 0, k % every_log == 0
            if controls or logs:
                _refuse_divergence(rig.v, k * dt)
                target, (q, v, tau) = reference.at(k * dt), past[0]
                reading = sensors.angle(q, rng), sensors.velocity(v, rng)
            if controls:
                command = _spread(controller.command(target, *reading), plant, "command of the controller")
            if logs:
                log.add(rig.q, rig.v, torque, *reading, sensors.torque(tau, rng), _spread(target.q, plant, "target"))
                if progress is not None:
                    progress(k / count)
            if k < count:
                drive = actuator.drive(state, command, dt)
                step = rig.step(drive.torque, drive.damping)
                state = actuator.advance(state, command, step.mean_velocity, dt)
                audit.add(drive.torque - drive.damping * step.mean_velocity, step, dt)
                torque = actuator.torque(state, command)
    time = every_log * dt * np.arange(len(log.samples), dtype=np.float64)
    q, v, tau, q_measured, v_measured, tau_measured, aim = log.arrays()
    return Run(plant, time, q, v, tau, q_measured, v_measured, tau_measured, aim, audit.energy(rig.energy()))


def _step_count(duration: float, rates: Rates) -> int:
    count = duration / rates.step
    if not (np.isfinite(count) and count >= 0.5):
        raise ExoidError(f"a run of {duration:g} s", remedy=f"give a duration of at least {rates.step:g} s")
    return round(count)


def _start(plant: Plant, reference: Reference, start: ArrayLike | None) -> tuple[FloatArray, FloatArray]:
    """Angles and velocities to begin with."""
    first = reference.at(0.0)
    q = _spread(first.q if start is None else start, plant, "start")
    v = _spread(first.v if start is None else 0.0, plant, "velocity of the reference")
    if not (np.isfinite(q).all() and np.isfinite(v).all()):
        raise ExoidError("the start is not finite", remedy="give angles in rad")
    beyond = (q < plant.lower - STOP_TOLERANCE) | (q > plant.upper + STOP_TOLERANCE)
    if beyond.any():
        joint, which = np.argwhere(beyond)[0]
        raise ExoidError(
            f"{plant.leg.joint_names[joint]} starts at {q[joint, which]:.4g} rad in rig {which}, beyond its end stops "
            f"at {plant.lower[joint, which]:.4g} and {plant.upper[joint, which]:.4g} rad",
            remedy="start between them, or build the plant with end_stops=False",
        )
    return q, v


def _spread(values: ArrayLike, plant: Plant, name: str) -> FloatArray:
    """Spread values over joints and rigs."""
    try:
        return np.broadcast_to(np.asarray(values, dtype=np.float64), (plant.n, plant.count))
    except (TypeError, ValueError) as error:
        raise ExoidError(
            f"{name}: shape {np.shape(values)} for {plant.n} joints of {plant.count} rigs",
            remedy=f"give ({plant.n}, {plant.count}) or ({plant.n}, 1) numbers",
        ) from error


class _Log:
    """Samples of a run in the making."""

    def __init__(self) -> None:
        self.samples: list[tuple[FloatArray, ...]] = []

    def add(self, *sample: FloatArray) -> None:
        self.samples.append(sample)

    def arrays(self) -> tuple[FloatArray, ...]:
        return tuple(np.array(x) for x in zip(*self.samples, strict=True))


class _Audit:
    """Energy of a run in the making."""

    def __init__(self, plant: Plant, begin: FloatArray) -> None:
        self._plant, self._begin = plant, begin
        self._work, self._dissipated, self._turnover = np.zeros((3, plant.count))

    def add(self, torque: FloatArray, step: Step, dt: float) -> None:
        travelled = dt * step.mean_velocity
        work = torque * travelled
        self._work += work.sum(axis=0)
        self._turnover += np.abs(work).sum(axis=0)
        self._dissipated += ((step.taken + self._plant.viscous * travelled) * step.mean_velocity).sum(axis=0)

    def energy(self, end: FloatArray) -> Energy:
        turnover = np.maximum(self._turnover, self._dissipated)
        return Energy(self._work, end - self._begin, self._dissipated, turnover)


def _refuse_divergence(v: FloatArray, time: float) -> None:
    if not (np.abs(v) < FASTEST).all():
        raise ExoidError(
            f"the rig diverged before {time:.3g} s",
            remedy="lower the gain, add damping or leakage, or shorten the step",
        )
