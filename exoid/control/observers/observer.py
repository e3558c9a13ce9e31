"""Observer of the torque that acts on a leg from outside: balance of momentum, then a linear filter."""

from __future__ import annotations

import warnings
from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import KW_ONLY, dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import ArrayLike, FloatArray
from exoid.control.friction import WIDTH
from exoid.control.law import refuse_rate
from exoid.control.model import ControlModel, ModelSource
from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.signals import Recording

from .alignment import Alignment, AlignmentMemory, Channels
from .checks import observed_channels, refuse_reading
from .joint_filters import JointFilters
from .momentum_terms import MomentumTerms
from .noise_band import NoiseBand, Residual
from .parameter_band import MomentumColumns, ParameterBand
from .reading import ObservedTorque, ObserverReading
from .sensor_noise import SensorNoise

BLOCK = 4096
"""Samples of a log worked on at once."""

CUTOFF = 1.0
"""Default cut-off of the channels' low-pass over the observer's bandwidth: near the least noise for a delay;"""

LARGEST = 0.2
"""at most over the sampling rate."""

SLOWEST = 20.0
"""Smallest default cut-off [Hz]. The low-pass acts on angles inside sines and products, where it causes a bias: with
10 Hz, ten minutes of fast unworn motion raised alarms, with 20 Hz none."""

FASTEST = 30.0
"""Default cut-off where no bandwidth is given [Hz]."""

STICTION = 1.2
"""Static friction over friction in slow motion, an assumption: an estimate of Coulomb friction does not show it."""

SETTLING = 6.0
"""Delays of the observer after which what was unknown at the beginning is forgotten."""


class ObserverMemory(NamedTuple):
    """Memory of an observer between samples.

    Attributes:
        samples: Samples read so far.
        q: Last angles [rad], (n,).
        alignment: Memory of the channels' filters.
        p: Last momentum [N·m·s], (n,).
        torque: Last sum of actuator's and model's torque [N·m], (n,).
        columns: Last columns of the parameters, (K, n) each; K is 0 without an estimate.
        filtered: Memory of the filter of the balance, (m, n).
        filtered_columns: The same of the columns, (m, K, n).
        filtered_stiction: The same of the unknown friction, (m, n).
    """

    samples: int
    q: FloatArray
    alignment: AlignmentMemory
    p: FloatArray
    torque: FloatArray
    columns: MomentumColumns
    filtered: FloatArray
    filtered_columns: FloatArray
    filtered_stiction: FloatArray


@dataclass(frozen=True, eq=False, repr=False)
class TorqueObserver(ABC):
    """Base of observers: the mean external torque of each sampling interval by the balance of momentum, then a filter.

    With p = M(q) v, ṗ = τ + τ_wearer + Cᵀv − G − springs − friction. Over an interval T, by the trapezoidal rule,

        τ̄_k = (p_k − p_{k−1}) / T − (u_k + u_{k−1}) / 2,    u = τ + Cᵀv − G − springs − friction,

    and the reading is a stable linear filter of τ̄. No acceleration is needed. Objects are frozen; the memory is
    explicit. Pinocchio's work memory is inside: make one observer for each thread.

    Attributes:
        source: Model: an estimate, whose covariance gives a band, a leg, a plant of one rig or a control model.
        bandwidth: −3 dB frequency from the torque of the wearer to the reading, without the channels' low-pass [Hz], a
            number or (n,).
        rate: Sampling rate [Hz].
        cutoff: Cut-off of the low-pass of all channels [Hz]; inf for none, where velocities are measured. None for the
            bandwidth or 20 Hz, the larger, at most a fifth of the rate.
        noise: Noise of the sensors. None if it is unknown: :meth:`run` then measures it in the log, and :meth:`step`
            detects nothing.
        false_alarms: False alarms per minute, all joints together, for noise alone.
        torque_delay: Lag of measured torques behind angles [s], a number or (n,); None for the ``torque_delays`` of the
            estimate. A torque that is held from one sample to the next lags by −T/2 where it is logged at the beginning
            of its interval, and by T/2 at the end.
        velocity_delay: Lag of measured velocities behind angles [s], likewise.
        width: Width of the smooth sign of friction [rad/s].
        stiction: Static friction over friction in slow motion.

    Raises:
        ExoidError: A number is out of range, the noise is unknown, or the model cannot be used.
    """

    source: ModelSource
    bandwidth: ArrayLike | None
    rate: float
    _: KW_ONLY
    cutoff: float | None = None
    noise: SensorNoise | None = None
    false_alarms: float = 1e-3
    torque_delay: ArrayLike | None = None
    velocity_delay: ArrayLike = 0.0
    width: float = WIDTH
    stiction: float = STICTION

    def __post_init__(self) -> None:
        """Check the settings."""
        refuse_rate(self.rate)
        _ = self.band, self.terms

    @property
    @abstractmethod
    def filters(self) -> JointFilters:
        """Filter of the balance of each joint, with gain 1 for constant torques."""

    @property
    @abstractmethod
    def gain(self) -> FloatArray:
        """Gain of the observer."""

    @property
    def delay(self) -> FloatArray:
        """Delay of slow torques from the leg to the reading, with that of the channels' low-pass [s], (n,)."""
        b, a = self.filters.b, self.filters.a
        powers = np.arange(self.filters.order + 1.0)
        samples = powers @ b / b.sum(axis=0) - powers @ a / a.sum(axis=0) + 0.5
        return np.asarray(samples / self.rate + self.alignment.delay)

    def response(self, frequency: float) -> FloatArray:
        """Compute the frequency response from the torque of the wearer to the reading.

        Args:
            frequency: Frequency [Hz].

        Returns:
            Complex gains, (n,).
        """
        gain = self.filters.response(frequency, self.rate) * np.sinc(frequency / self.rate)
        late = 0.5 / self.rate + self.alignment.waiting
        if self.alignment.filters is not None:
            gain = gain * self.alignment.filters[0].response(frequency, self.rate)
        return np.asarray(gain * np.exp(-2j * np.pi * frequency * late))

    @property
    def threshold(self) -> FloatArray:
        """Threshold of detection in standard deviations, (n,)."""
        return self.band.level

    @property
    def settling(self) -> int:
        """Samples at the beginning without detection."""
        return int(np.ceil(SETTLING * self.delay.max() * self.rate))

    def begin(self, q: ArrayLike, v: ArrayLike | None = None, tau: ArrayLike | None = None) -> ObserverMemory:
        """Make the memory at the first sample. Readings begin at zero.

        Args:
            q: Angles [rad], (n,).
            v: Velocities [rad/s], (n,), if the leg moves, also where they are derived later; None if it rests.
            tau: Torques [N·m], (n,); None for those that hold the leg.

        Returns:
            The memory.

        Raises:
            ExoidError: A reading has another shape or is not finite, or velocities are needed.

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
        speed = np.zeros_like(angle) if v is None else np.array(v, dtype=np.float64)
        refuse_reading(Channels(angle, speed, angle), np.resize(angle, self.model.n), self.rate, self._names)
        torque = -self.terms.at(angle, speed).model if tau is None else np.array(tau, dtype=np.float64)
        refuse_reading(Channels(angle, speed, torque), angle, self.rate, self._names)
        channels, alignment = self.alignment.begin(angle, speed, torque)
        assert channels.v is not None
        terms, columns = self.terms.at(channels.q, channels.v), self._columns(channels.q[None], channels.v[None])
        return ObserverMemory(
            0,
            angle,
            alignment,
            terms.p,
            channels.tau + terms.model,
            MomentumColumns(columns.p[0], columns.model[0]),
            np.zeros((self.filters.order, self.model.n)),
            np.zeros((self.filters.order, *columns.p[0].shape)),
            self.filters.settled(terms.unknown),
        )

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
        speed = None if v is None else np.asarray(v, dtype=np.float64)
        reading = Channels(np.array(q, dtype=np.float64), speed, np.asarray(tau, dtype=np.float64))
        refuse_reading(reading, memory.q, self.rate, self._names)
        self._refuse_no_velocity(v is None)
        channels, alignment = self.alignment.step(memory.alignment, reading)
        assert channels.v is not None
        terms, columns = self.terms.at(channels.q, channels.v), self._columns(channels.q[None], channels.v[None])
        torque = channels.tau + terms.model
        now = MomentumColumns(columns.p[0], columns.model[0])
        torque_read, filtered = self.filters.step(
            memory.filtered, self._balance(terms.p, memory.p, torque, memory.torque)
        )
        of_columns = self._balance(now.p, memory.columns.p, now.model, memory.columns.model)
        moved, filtered_columns = self.filters.step(memory.filtered_columns, of_columns)
        bound, filtered_stiction = self.filters.step(memory.filtered_stiction, terms.unknown)
        parts = torque_read[None], moved[None], bound[None]
        found = self._judged(*parts, terms.M[None], np.array([memory.samples]), derived=v is None)
        after = ObserverMemory(
            memory.samples + 1,
            reading.q,
            alignment,
            terms.p,
            torque,
            now,
            filtered,
            filtered_columns,
            filtered_stiction,
        )
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
        recording, channels = observed_channels(self.source, recording, self.rate)
        if self.noise is None:
            return replace(self, noise=SensorNoise.of(recording)).run(recording)
        before = np.vstack([channels.q[:1], channels.q[:-1]])
        refuse_reading(channels, before, self.rate, self._names)
        self._refuse_no_velocity(channels.v is None)
        speed = self._first_velocity(channels.q) if channels.v is None else channels.v[0]
        blocks = list(self._blocks(self.begin(channels.q[0], speed, channels.tau[0]), channels))
        found = ObserverReading(*map(np.concatenate, zip(*blocks, strict=True)))
        return ObservedTorque(recording.time, *found, joint_names=self._names, delay=self.delay, settling=self.settling)

    def _first_velocity(self, q: FloatArray) -> FloatArray:
        """Mean velocity over the first samples of a log, as long as the delay of the channels, (n,)."""
        count = min(max(1, round(self.alignment.delay * self.rate)), len(q) - 1)
        return np.asarray((q[count] - q[0]) * self.rate / count)

    def _blocks(self, memory: ObserverMemory, channels: Channels) -> Iterator[ObserverReading]:
        """Readings of a log, (B, n) each."""
        derived = channels.v is None
        for start in range(0, len(channels.q), BLOCK):
            rows = slice(start, start + BLOCK)
            block = Channels(channels.q[rows], None if channels.v is None else channels.v[rows], channels.tau[rows])
            aligned, alignment = self.alignment.run(memory.alignment, block)
            assert aligned.v is not None
            terms, columns = self.terms.over(aligned.q, aligned.v), self._columns(aligned.q, aligned.v)
            torque = aligned.tau + terms.model
            balance = self._balance(terms.p, _late(memory.p, terms.p), torque, _late(memory.torque, torque))
            of_columns = self._balance(
                columns.p,
                _late(memory.columns.p, columns.p),
                columns.model,
                _late(memory.columns.model, columns.model),
            )
            read, filtered = self.filters.run(memory.filtered, balance)
            moved, filtered_columns = self.filters.run(memory.filtered_columns, of_columns)
            bound, filtered_stiction = self.filters.run(memory.filtered_stiction, terms.unknown)
            samples = memory.samples + np.arange(len(read))
            yield self._judged(read, moved, bound, terms.M, samples, derived=derived)
            memory = ObserverMemory(
                memory.samples + len(read),
                block.q[-1],
                alignment,
                terms.p[-1],
                torque[-1],
                MomentumColumns(columns.p[-1], columns.model[-1]),
                filtered,
                filtered_columns,
                filtered_stiction,
            )

    def _balance(self, p: FloatArray, p_before: FloatArray, u: FloatArray, u_before: FloatArray) -> FloatArray:
        """Mean of ṗ − u over the sampling interval."""
        return np.asarray((p - p_before) * self.rate - 0.5 * (u + u_before))

    def _judged(
        self,
        torque: FloatArray,
        moved: FloatArray,
        bound: FloatArray,
        M: FloatArray,
        samples: NDArray[np.int_],
        *,
        derived: bool,
    ) -> ObserverReading:
        """Add band and detection to filtered balances, (N, n)."""
        variance = self.band.variance(M, derived=derived)
        if self.parameters is not None:
            variance = variance + self.parameters.variance(moved)
        std, stiction = np.sqrt(variance), self._reach * np.clip(bound, 0.0, None)
        detected = (np.abs(torque) > stiction + self.threshold * std) & (samples >= self.settling)[:, None]
        return ObserverReading(torque, std, stiction, detected)

    def _columns(self, q: FloatArray, v: FloatArray) -> MomentumColumns:
        if self.parameters is not None:
            return self.parameters.columns(q, v)
        nothing = np.zeros((len(q), 0, q.shape[1]))
        return MomentumColumns(nothing, nothing)

    def _refuse_no_velocity(self, derived: bool) -> None:
        if derived and self.alignment.filters is None:
            raise ExoidError(
                "velocities are neither measured nor derived, as cutoff is inf", remedy="give velocities, or a cutoff"
            )

    @cached_property
    def _names(self) -> tuple[str, ...]:
        return self.model.leg.joint_names

    @cached_property
    def _reach(self) -> FloatArray:
        """Sum of the absolute impulse response of the filter: what a bounded error can become at most, (n,)."""
        return np.asarray(np.abs(self.filters.impulse_response(np.array([1.0]))).sum(axis=0))

    @cached_property
    def model(self) -> ControlModel:
        """Model of the leg."""
        return ControlModel.of(self.source)

    @cached_property
    def terms(self) -> MomentumTerms:
        """Momentum and torques of the model."""
        return MomentumTerms(self.model, self.width, self.stiction)

    @cached_property
    def parameters(self) -> ParameterBand | None:
        """Columns of the estimate's parameters; None without an estimate."""
        return ParameterBand(self.source) if isinstance(self.source, Estimate) else None

    @cached_property
    def band(self) -> NoiseBand:
        """Noise of the reading."""
        residual = Residual.of(self.source) if isinstance(self.source, Estimate) else None
        return NoiseBand.of(self.alignment, self.filters, self.noise, residual, self.false_alarms)

    @cached_property
    def alignment(self) -> Alignment:
        """Filters of the channels."""
        n = self.model.n
        if self.torque_delay is None:
            torque = self.source.torque_delays if isinstance(self.source, Estimate) else np.zeros(n)
        else:
            torque = np.asarray(self.torque_delay, dtype=np.float64)
        velocity = np.asarray(self.velocity_delay, dtype=np.float64)
        if any(x.shape not in ((), (n,)) or not np.isfinite(x).all() for x in (torque, velocity)):
            raise ExoidError("delays do not fit the joints", remedy=f"give a finite number, or {n} of them, in seconds")
        lags = np.stack([np.broadcast_to(velocity, n), np.broadcast_to(torque, n)])
        cutoff = self.cutoff
        if cutoff is None:
            wanted = FASTEST if self.bandwidth is None else max(SLOWEST, CUTOFF * float(self.bandwidths.max()))
            cutoff = min(wanted, LARGEST * self.rate)
        if not 0.0 < cutoff < 0.5 * self.rate and cutoff != np.inf:
            raise ExoidError(
                f"a low-pass at {cutoff:g} Hz for channels at {self.rate:g} Hz",
                remedy="give a cut-off below half the rate, or inf for none",
            )
        return Alignment(n, self.rate, cutoff, lags)

    @cached_property
    def bandwidths(self) -> FloatArray:
        """−3 dB frequency of each joint [Hz], (n,)."""
        given = np.asarray(self.bandwidth, dtype=np.float64)
        if given.shape not in ((), (self.model.n,)) or not ((given > 0.0) & np.isfinite(given)).all():
            raise ExoidError(
                f"a bandwidth of {self.bandwidth!r}", remedy="give a positive number in Hz, or one for each joint"
            )
        return np.broadcast_to(given, self.model.n).copy()

    def __repr__(self) -> str:
        """Write bandwidth, rate and delay in one line."""
        bandwidth = ", ".join(f"{x:.3g}" for x in np.unique(self.bandwidths))
        return (
            f"{type(self).__name__}({', '.join(self._names)}: {bandwidth} Hz at {self.rate:g} Hz, "
            f"delay {1e3 * self.delay.max():.3g} ms)"
        )


def _late(first: FloatArray, values: FloatArray) -> FloatArray:
    """Values one sample earlier."""
    return np.concatenate([first[None], values[:-1]])
