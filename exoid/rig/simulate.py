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
            ExoidError: A period is not a multiple of the step.
        """
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
        turnover: ∫ |power| dt of the actuators, to compare errors with.
    """

    work: FloatArray
    gain: FloatArray
    dissipated: FloatArray
    turnover: FloatArray

    @property
    def relative_error(self) -> FloatArray:
        """Energy that came from nowhere, over the turnover, (B,)."""
        return np.asarray(np.abs(self.work - self.gain - self.dissipated) / self.turnover)


@dataclass(frozen=True, eq=False)
class Run:
    """What B rigs did, and what their sensors said; K log samples.

    Attributes:
        plant: The truth.
        time: [s], (K,).
        q: True angles [rad], (K, n, B).
        v: True velocities [rad/s], (K, n, B).
        tau: True actuator torques [N·m], (K, n, B).
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
        """
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
        ExoidError: Rates do not fit, or the run diverges.
    """
    rates, sensors = rates or Rates(), sensors or Sensors(encoder_counts=np.inf)
    rng = np.random.default_rng(seed)
    every_control, every_log = rates.steps()
    dt, shape, count = rates.step, (plant.n, plant.count), round(duration / rates.step)
    first = reference.at(0.0)
    q0 = np.broadcast_to(first.q if start is None else np.asarray(start, dtype=np.float64), shape)
    rig = stepper(plant, q0, np.broadcast_to(first.v if start is None else 0.0, shape), dt)
    state, command, torque = np.zeros((3, *shape))
    readings: deque[tuple[FloatArray, FloatArray]] = deque(maxlen=sensors.delay + 1)
    log = _Log()
    audit = _Audit(plant, rig.energy())
    for k in range(count + 1):
        if k % every_control == 0 or k % every_log == 0:
            target = reference.at(k * dt)
            readings.append((sensors.angle(rig.q, rng), sensors.velocity(rig.v, rng)))
        if k % every_control == 0:
            command = controller.command(target, *readings[0])
        if k % every_log == 0:
            log.add(rig.q, rig.v, torque, *readings[0], sensors.torque(torque, rng), np.broadcast_to(target.q, shape))
            _refuse_divergence(rig.q, k * dt)
            if progress is not None:
                progress(k / max(count, 1))
        if k == count:
            break
        drive = actuator.drive(state, command, dt)
        step = rig.step(drive.torque, drive.damping)
        state = actuator.advance(state, command, step.mean_velocity, dt)
        torque = drive.torque - drive.damping * step.mean_velocity
        audit.add(torque, step, dt)
    time = every_log * dt * np.arange(len(log.samples), dtype=np.float64)
    q, v, tau, q_measured, v_measured, tau_measured, aim = log.arrays()
    energy = audit.energy(rig.energy())
    return Run(plant, time, q, v, tau, q_measured, v_measured, tau_measured, aim, energy)


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
        return Energy(self._work, end - self._begin, self._dissipated, self._turnover)


def _refuse_divergence(q: FloatArray, time: float) -> None:
    if not np.isfinite(q).all():
        raise ExoidError(
            f"the rig diverged before {time:.3g} s",
            remedy="lower the gain, add damping or leakage, or shorten the step",
        )
