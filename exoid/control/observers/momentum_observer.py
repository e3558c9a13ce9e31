"""Observer of the torque that acts on a leg from outside: balance of momentum, then a filter of first order."""

from __future__ import annotations

import warnings
from dataclasses import KW_ONLY, dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.codegen import Dialect, LawInC
from exoid.control.friction import WIDTH
from exoid.control.law import refuse_rate
from exoid.control.model import ControlModel, ModelSource
from exoid.errors import BadArgumentError
from exoid.estimate import Estimate
from exoid.leg.closure import BLOCK
from exoid.leg.joint_numbers import for_joints
from exoid.signals import Recording
from exoid.tools.numbers import checked
from exoid.torques.position_units import position_units

from .alignment import Alignment, AlignmentMemory, JointFilter
from .in_c import observer_in_c
from .momentum import MomentumModel
from .noise import NoiseBand, SensorNoise
from .readings import ObservedTorque, ObserverReading, observed_log, refuse_contradictions, refuse_readings


class ObserverMemory(NamedTuple):
    """Memory of an observer between samples."""

    samples: int  # samples read so far
    q: FloatArray  # last angles [rad], (n,)
    alignment: AlignmentMemory  # memory of the channels' filters
    p: FloatArray  # last momentum [N·m·s] and its columns, (1 + K, n)
    u: FloatArray  # last sum of actuator's and model's torque [N·m], and its columns, (1 + K, n)
    filtered: FloatArray  # memory of the filter of the balance, of its columns, and of unknown friction, (m, 2 + K, n)
    derived: bool | None = None  # whether velocities were derived; None before the first sample


@dataclass(frozen=True, eq=False, repr=False)
class MomentumObserver:
    """r = K (p − ∫ (u + r) dt) with u = τ + Cᵀv − G − springs − friction and p = M(q) v (De Luca and Mattone 2003).

    So ṙ = K (τ_wearer − r): the torque of the wearer, smoothed with time constant 1/K. No acceleration is needed. Over
    an interval T, the mean torque from outside is, by the trapezoidal rule,

        τ̄_k = (p_k − p_{k−1}) / T − (u_k + u_{k−1}) / 2,    r_k = e^{−KT} r_{k−1} + (1 − e^{−KT}) τ̄_k.

    The discrete filter is exact for torques that are constant over each interval, and stable for every K and rate. Its
    impulse response is positive, so that a bounded error of friction stays within its filtered bound. Objects are
    frozen; the memory is explicit.

    Attributes:
        source: Model: an estimate, whose covariance gives a band, a leg, a plant of one rig or a control model.
        bandwidth: −3 dB frequency from the wearer's torque to the reading, without the channels' low-pass [Hz].
        rate: Sampling rate [Hz]. :meth:`run` compares it with time stamps; :meth:`step` has none, and reads wrongly at
            another one.
        cutoff: Cut-off of the low-pass of all channels [Hz]; inf for none, where velocities are measured. None for the
            bandwidth or 20 Hz, the larger, at most a fifth of the rate.
        noise: Noise of the sensors. None if it is unknown: :meth:`run` then measures it in the log, and :meth:`step`
            detects nothing.
        false_alarms: False alarms per minute, all joints together, for noise alone.
        torque_delay: Lag of measured torques behind angles [s], a number or (n,); None for the ``torque_delays`` of the
            estimate. A torque that is held from one sample to the next lags by −T/2 where it is logged at the beginning
            of its interval, and by T/2 at the end.
        velocity_delay: Lag of measured velocities behind angles [s], likewise.
        width: Width of the smooth sign of friction [rad/s], a tenth of it in m/s where a joint slides.
        stiction: Static friction over friction in slow motion: an assumption, as Coulomb friction does not show it.

    Raises:
        ExoidError: A number is out of range, or the model cannot be used.

    Example:
        >>> import exoid
        >>> data = exoid.datasets.bleex_swing()
        >>> observer = MomentumObserver(exoid.identify(data.leg, data.train), bandwidth=16.0, rate=100.0)
        >>> observer
        MomentumObserver(left_hip, left_knee, left_ankle: 16 Hz at 100 Hz, delay 20.5 ms)
    """

    source: ModelSource
    bandwidth: float
    rate: float
    _: KW_ONLY
    cutoff: float | None = None
    noise: SensorNoise | None = None
    false_alarms: float = 1e-3
    torque_delay: ArrayLike | None = None
    velocity_delay: ArrayLike = 0.0
    width: float = WIDTH
    stiction: float = 1.2

    def __post_init__(self) -> None:
        """Check the settings."""
        refuse_rate(self.rate)
        checked(self.bandwidth, "bandwidth [Hz]", above=0.0, ndim=0)
        _ = self.band, self.terms

    @cached_property
    def filter(self) -> JointFilter:
        """(1 − e^{−KT}) / (1 − e^{−KT} z⁻¹)."""
        pole = np.exp(-2.0 * np.pi * self.bandwidth / self.rate)  # K = 2π bandwidth
        return JointFilter(np.array([1.0 - pole, 0.0]), np.array([1.0, -pole]))

    def in_c(self, dialect: Dialect) -> LawInC:
        """Describe the observer in C, with measured velocities: its torque, without band and detection.

        Args:
            dialect: Precision and prefix of the C.

        Returns:
            Description of inputs, memory and steps.
        """
        return observer_in_c(self.model, self.alignment, self.filter, self.settling, self.width, dialect)

    @cached_property
    def delay(self) -> float:
        """Delay of slow torques from the leg to the reading, with that of the channels' low-pass [s]."""
        pole = -float(self.filter.a[1])
        samples = pole / (1.0 - pole) + 0.5  # half a sample, as the balance is a mean over an interval
        return samples / self.rate + self.alignment.delay

    @property
    def threshold(self) -> float:
        """Threshold of detection in standard deviations."""
        return self.band.level

    @cached_property
    def settling(self) -> int:
        """Samples at the beginning without detection: six delays, after which the beginning is forgotten."""
        return int(np.ceil(6.0 * self.delay * self.rate))

    def begin(self, q: ArrayLike, v: ArrayLike | None = None, tau: ArrayLike | None = None) -> ObserverMemory:
        """Make the memory at the first sample. Readings begin at zero.

        Args:
            q: Angles [rad], (n,).
            v: Velocities [rad/s], (n,), if the leg moves, also where they are derived later; None if it rests.
            tau: Torques [N·m], (n,); None for those that hold the leg.

        Returns:
            The memory.

        Raises:
            ExoidError: A reading has another shape or is not finite.

        Warns:
            UserWarning: The noise of the sensors is unknown, so that nothing is detected.
        """
        if self.noise is None:
            warnings.warn(
                "the noise of the sensors is unknown: nothing is detected. Give noise=SensorNoise(...), or "
                "SensorNoise.of(recording)",
                UserWarning,
                stacklevel=2,
            )
        angle = np.array(q, dtype=np.float64)
        first = _stacked(angle, np.zeros_like(angle) if v is None else v, angle if tau is None else tau)
        refuse_readings(first, first[0, 0], self.rate, self.names)
        if tau is None:
            first[:, 2] = -self.terms.over(first[:, 0], first[:, 1]).u[:, 0]
        aligned, alignment = self.alignment.begin(first[0])
        now = self.terms.over(aligned[None, 0], aligned[None, 1])
        now.u[:, 0] += aligned[2]
        filtered = np.zeros((len(self.filter.b) - 1, now.p.shape[1] + 1, self.model.n))
        filtered[:, -1] = self.filter.settled(now.unknown[0])
        return ObserverMemory(0, angle, alignment, now.p[0], now.u[0], filtered)

    def step(
        self, memory: ObserverMemory, q: ArrayLike, v: ArrayLike | None, tau: ArrayLike
    ) -> tuple[ObserverReading, ObserverMemory]:
        """Read one sample.

        Args:
            memory: Memory.
            q: Angles [rad], (n,).
            v: Measured velocities [rad/s], (n,); None to derive them from the angles, at every sample.
            tau: Torques of the actuators [N·m], (n,).

        Returns:
            The reading, and the memory for the next sample. The memory given is left as it is.

        Raises:
            ExoidError: A reading is not finite, an angle jumps, or velocities are needed.
        """
        rows = _stacked(np.asarray(q, dtype=np.float64), v, tau)
        refuse_readings(rows, memory.q, self.rate, self.names)
        found, after = self._read(memory, rows, derived=v is None)
        return ObserverReading(*(x[0] for x in found)), after

    def run(self, recording: Recording) -> ObservedTorque:
        """Read a whole log: the same as :meth:`step` sample by sample, without a loop over samples.

        Args:
            recording: The log at the observer's rate, with torques; joints may stand in any order.

        Returns:
            Readings of all samples.

        Raises:
            ExoidError: The log has no torques or other joints, another rate, gaps or jumps, a base that moves, or
                payloads.
        """
        recording = observed_log(self.source, recording, self.rate)
        if self.noise is None:
            return replace(self, noise=SensorNoise.of(recording)).run(recording)
        q, v, derived = recording.q, recording.v, recording.v is None
        rows = _stacked(q, v, recording.tau)
        refuse_readings(rows, q[0], self.rate, self.names, "the log")
        if v is not None:
            refuse_contradictions(recording, v, self.alignment.lags[0])
        # the mean velocity over the delay of the channels
        count = min(max(1, round(self.alignment.delay * self.rate)), len(q) - 1)
        memory = self.begin(q[0], (q[count] - q[0]) * self.rate / count if v is None else v[0], rows[0, 2])
        blocks = []
        for start in range(0, len(rows), BLOCK):
            found, memory = self._read(memory, rows[start : start + BLOCK], derived=derived)
            blocks.append(found)
        whole = ObserverReading(*map(np.concatenate, zip(*blocks, strict=True)))
        units = position_units(self.model.leg)
        return ObservedTorque(recording.time, *whole, self.names, self.delay, self.settling, units)

    def _read(
        self, memory: ObserverMemory, rows: FloatArray, *, derived: bool
    ) -> tuple[ObserverReading, ObserverMemory]:
        """Readings (N, n) of consecutive samples (N, 3, n), and the memory after them."""
        if derived and self.alignment.filters is None:
            what = "velocities are neither measured nor derived, as cutoff is inf"
            raise BadArgumentError(what, remedy="give velocities, or a cutoff")
        if memory.derived not in (None, derived):  # their filter would start with zeros, or with old ones
            what = "velocities came with some samples and not with others"
            raise BadArgumentError(what, remedy="give them at every sample, or never; begin again where that changes")
        aligned, alignment = self.alignment.run(memory.alignment, rows, derived=derived)
        now = self.terms.over(aligned[:, 0], aligned[:, 1])
        now.u[:, 0] += aligned[:, 2]
        p, u = np.concatenate([memory.p[None], now.p]), np.concatenate([memory.u[None], now.u])
        balance = np.diff(p, axis=0) * self.rate - 0.5 * (u[1:] + u[:-1])
        read, filtered = self.filter.run(memory.filtered, np.concatenate([balance, now.unknown[:, None]], axis=1))
        torque, moved, bound = read[:, 0], read[:, 1:-1], read[:, -1]
        variance = self.band.variance(now.M, derived=derived)
        if isinstance(self.source, Estimate):
            # of parameters and of the model: noise is that of the band
            variance = variance + self.source.measured_variance(moved.transpose(0, 2, 1), bandwidth=0.0)
        std, stiction = np.sqrt(variance), np.clip(bound, 0.0, None)
        settled = memory.samples + np.arange(len(rows)) >= self.settling
        detected = (np.abs(torque) > stiction + self.threshold * std) & settled[:, None]
        after = ObserverMemory(memory.samples + len(rows), rows[-1, 0], alignment, p[-1], u[-1], filtered, derived)
        return ObserverReading(torque, std, stiction, detected), after

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Joints, (n,)."""
        return self.model.leg.joint_names

    @cached_property
    def model(self) -> ControlModel:
        """Model of the leg."""
        return ControlModel.of(self.source)

    @cached_property
    def terms(self) -> MomentumModel:
        """Momentum and torques of the model."""
        estimate = self.source if isinstance(self.source, Estimate) else None
        return MomentumModel(self.model, self.width, self.stiction, estimate)

    @cached_property
    def band(self) -> NoiseBand:
        """Noise of the reading."""
        return NoiseBand.of(self.alignment, self.filter, self.noise, self.source, self.false_alarms)

    @cached_property
    def alignment(self) -> Alignment:
        """Filters of the channels."""
        n, delays = self.model.n, self.torque_delay
        if delays is None:
            delays = self.source.torque_delays if isinstance(self.source, Estimate) else 0.0
        given = [for_joints(lag, n, "delays") for lag in (self.velocity_delay, delays)]
        lags = checked(given, "a delay [s]", least=-0.5, most=0.5, ndim=2)  # more is a number in ms
        cutoff = self.cutoff
        if cutoff is None:
            # Near the bandwidth noise is least for a delay. The low-pass acts on angles inside sines and products,
            # where it causes a bias: with 10 Hz, ten minutes of fast unworn motion raised alarms, with 20 Hz none.
            cutoff = min(max(20.0, self.bandwidth), 0.2 * self.rate)
        if not 0.0 < cutoff < 0.5 * self.rate and cutoff != np.inf:
            what = f"a low-pass at {cutoff:g} Hz for channels at {self.rate:g} Hz"
            raise BadArgumentError(what, remedy="give a cut-off below half the rate, or inf for none")
        return Alignment(n, self.rate, cutoff, lags)

    def __repr__(self) -> str:
        """Write bandwidth, rate and delay in one line."""
        return (
            f"MomentumObserver({', '.join(self.names)}: {self.bandwidth:.3g} Hz at {self.rate:g} Hz, "
            f"delay {1e3 * self.delay:.3g} ms)"
        )


def _stacked(q: FloatArray, v: ArrayLike | None, tau: ArrayLike | None) -> FloatArray:
    """Angles, velocities (zeros where there are none) and torques, (N, 3, n)."""
    parts = [np.atleast_2d(np.zeros_like(q) if x is None else np.asarray(x, dtype=np.float64)) for x in (q, v, tau)]
    if len({part.shape for part in parts}) > 1:
        shapes = ", ".join(str(part.shape[1:]) for part in parts)
        raise BadArgumentError(f"readings of shapes {shapes}", remedy="give one value for each joint")
    return np.stack(parts, axis=1)
