"""Named ways from a recording to the kinematics and filtered torques that identification compares."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import ClassVar, Protocol

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .differentiation import Accuracy, Kinematics, central_difference, second_difference
from .filters import TOLERANCE, edge_length, exponential_moving_average, zero_phase
from .parallel_filter import ParallelFilter
from .recording import Recording

KINEMATICS_MULTIPLE = 2.0
"""Default kinematics cut-off over the parallel filter's.

The parallel filter falls on torques and columns alike and biases nothing; the kinematics filter falls on q
alone, inside sines and products, and biases. With order 4, twice the cut-off leaves 0.998 of an amplitude at
the cut-off and more below it; the noise of an acceleration grows with the cut-off to the power 5/2.
"""
LARGEST_SHARE = 0.4
"""Default kinematics cut-off over the sampling rate, at most."""


class Preparation(Protocol):
    """What identification asks of a way to prepare recordings.

    Use on a recording with even stamps (`Recording.resampled`): an uneven one is resampled inside, and the
    rows of the result are then those of ``recording.resampled()``. A type of preparation from outside exoid is a
    frozen dataclass, whose fields are its settings; see :func:`exoid.signals.register_preparation`.
    """

    @property
    def name(self) -> str:
        """Short name for evidence."""
        ...

    def kinematics(self, recording: Recording) -> Kinematics:
        """Derive what was not recorded, smooth, and say which rows to trust.

        Args:
            recording: Angles, and velocities and accelerations where they were measured.

        Returns:
            Angles, velocities and accelerations of all samples, and the slice of those that no filter spoils.
        """
        ...

    def filter(self, x: FloatArray, rate: float) -> FloatArray:
        """Filter measured torques.

        Args:
            x: Torques [N·m], (N, ...).
            rate: Sampling rate [Hz].

        Returns:
            Filtered torques [N·m], (N, ...).
        """
        ...

    def filter_columns(self, x: FloatArray, rate: float) -> FloatArray:
        """Filter regressor columns, unless `kinematics` has filtered them like the torques.

        Args:
            x: Columns, (N, ...).
            rate: Sampling rate [Hz].

        Returns:
            Filtered columns, (N, ...).
        """
        ...

    def parallel(self, rate: float) -> ParallelFilter | None:
        """Return the filter of `filter` and `filter_columns`, if they are alike and it can run on any stretch.

        Args:
            rate: Sampling rate [Hz].

        Returns:
            The filter; None where torques pass `filter` from the first sample on and columns stay as they are.
        """
        ...

    def independence(self, rate: float) -> float:
        """Return the share of filtered samples that carries independent noise.

        Args:
            rate: Sampling rate [Hz].

        Returns:
            The share, at most 1.
        """
        ...

    def describe(self) -> dict[str, float | str]:
        """Name and settings, for evidence.

        Returns:
            Settings by name, the name of the preparation under "name".
        """
        ...


@dataclass(frozen=True)
class ZeroPhase:
    """Smooth the angles without delay, derive, then pass columns and torques through one more filter alike.

    q, and v and a where recorded, are low-passed at the kinematics cut-off; what was not recorded follows by
    central differences over five points (three would take 1 % off the velocity of a 2 Hz motion sampled at
    50 Hz, five take 0.01 %). Columns and torques then pass the *parallel filter* at ``cutoff``: it keeps
    τ = W π true and takes noise away from both sides. Rows that the ends spoil through either filter are not
    valid.

    Attributes:
        cutoff: −3 dB frequency of the parallel filter [Hz].
        kinematics_cutoff: −3 dB frequency for q, v, a [Hz]; None for ``min(2 cutoff, 0.4 rate)``.
        order: Order of one of the two passes of each filter.
    """

    name: ClassVar[str] = "zero-phase"
    cutoff: float = 8.0
    kinematics_cutoff: float | None = None
    order: int = 4

    def __post_init__(self) -> None:
        for name in ("cutoff", "kinematics_cutoff"):
            value = getattr(self, name)
            if value is not None and not 0.0 < value < math.inf:
                raise ExoidError(f"{name} is {value}", remedy="pass a positive frequency in Hz")

    def kinematics_cutoff_at(self, rate: float) -> float:
        """Return the cut-off [Hz] for q, v, a sampled at ``rate`` [Hz]."""
        if self.kinematics_cutoff is not None:
            return self.kinematics_cutoff
        return min(KINEMATICS_MULTIPLE * self.cutoff, LARGEST_SHARE * rate)

    def edge(self, rate: float) -> int:
        """Return how many rows at each end the two filters spoil."""
        first = edge_length(rate, self.kinematics_cutoff_at(rate), self.order)
        return first + edge_length(rate, self.cutoff, self.order)

    def kinematics(self, recording: Recording) -> Kinematics:
        """Smooth and derive.

        Raises:
            ExoidError: A cut-off is not below half the rate, or nothing is left between the ends.
        """
        recording = recording.resampled()
        rate = recording.sample_rate
        cutoff = self.kinematics_cutoff_at(rate)
        valid = _inner(recording, self.edge(rate), self.edge(rate))
        return _derive(recording, lambda x: zero_phase(x, rate, cutoff, self.order), valid, accuracy=4)

    def filter(self, x: FloatArray, rate: float) -> FloatArray:
        """Low-pass torques at ``cutoff``; memory beyond the result does not grow with ``x``.

        Raises:
            ExoidError: The cut-off is not below half the rate, or there are too few samples.
        """
        return zero_phase(x, rate, self.cutoff, self.order)

    def filter_columns(self, x: FloatArray, rate: float) -> FloatArray:
        """Low-pass columns exactly as the torques."""
        return self.filter(x, rate)

    def parallel(self, rate: float) -> ParallelFilter:
        """Low-pass at ``cutoff``."""
        return ParallelFilter(rate, self.cutoff, self.order)

    def independence(self, rate: float) -> float:
        """Noise bandwidth of the parallel filter over half the rate."""
        return self.parallel(rate).independence

    def describe(self) -> dict[str, float | str]:
        """Name and settings."""
        chosen = f"min({KINEMATICS_MULTIPLE:g} cutoff, {LARGEST_SHARE:g} rate)"
        kinematics = chosen if self.kinematics_cutoff is None else self.kinematics_cutoff
        return {
            "name": self.name,
            "cutoff": self.cutoff,
            "kinematics_cutoff": kinematics,
            "order": self.order,
        }


@dataclass(frozen=True)
class _Unfiltered:
    """What preparations have in common after which torques and columns pass no filter."""

    name: ClassVar[str]

    def filter(self, x: FloatArray, rate: float) -> FloatArray:
        """Return the torques as they are."""
        return x

    def filter_columns(self, x: FloatArray, rate: float) -> FloatArray:
        """Return the columns as they are."""
        return x

    def parallel(self, rate: float) -> None:
        """None: columns are not filtered."""

    def independence(self, rate: float) -> float:
        """All samples: no torque is filtered."""
        return 1.0

    def describe(self) -> dict[str, float | str]:
        """Name and settings."""
        return {"name": self.name, **asdict(self)}


@dataclass(frozen=True)
class Smoothed(_Unfiltered):
    """Smooth the angles without delay and derive, but leave columns and torques as they are.

    For joints that truly stick and slip: a filter after sgn(v) would smear the jump of friction over rows that are left
    out on purpose, see :class:`exoid.torques.Coulomb` and its dead band.

    Attributes:
        cutoff: −3 dB frequency for q, v, a [Hz].
        order: Order of one of the two passes.
    """

    name: ClassVar[str] = "smoothed"
    cutoff: float = 10.0
    order: int = 4

    def kinematics(self, recording: Recording) -> Kinematics:
        """Smooth and derive.

        Raises:
            ExoidError: The cut-off is not below half the rate, or nothing is left between the ends.
        """
        recording = recording.resampled()
        rate = recording.sample_rate
        edge = edge_length(rate, self.cutoff, self.order)
        valid = _inner(recording, edge, edge)
        return _derive(recording, lambda x: zero_phase(x, rate, self.cutoff, self.order), valid, accuracy=4)


@dataclass(frozen=True)
class FiniteDifference(_Unfiltered):
    """Plain central differences and no filter, as doc. 1, sec. III-B; the first and last sample are dropped.

    Velocities and accelerations that were recorded are taken as they are.
    """

    name: ClassVar[str] = "finite-difference"

    def kinematics(self, recording: Recording) -> Kinematics:
        """Difference the angles.

        Raises:
            ExoidError: Time has a gap.
        """
        recording = recording.resampled()
        return _derive(recording, lambda x: x, _inner(recording, 1, 1), accuracy=2)


@dataclass(frozen=True)
class MovingAverage(_Unfiltered):
    """Smooth every measured signal by an exponential moving average, as doc. 2, sec. III.

    Velocity as measured where there is one, else by differences of the smoothed angle. All signals are late
    by the same (1 − α)/α samples, which biases sines and products. Columns are formed from smoothed signals
    and not smoothed again. Not valid are the rows until (1 − α)^k has fallen to a thousandth, and the last.

    Attributes:
        alpha: Weight of the newest sample, 0 < α ≤ 1. Doc. 2 prints none; 0.2 is an assumption.
    """

    name: ClassVar[str] = "moving-average"
    alpha: float = 0.2

    def __post_init__(self) -> None:
        if not 0.0 < self.alpha <= 1.0:
            raise ExoidError(f"alpha is {self.alpha}", remedy="pass 0 < alpha ≤ 1, the weight of the newest sample")

    def kinematics(self, recording: Recording) -> Kinematics:
        """Smooth and derive.

        Raises:
            ExoidError: Time has a gap, or the average has not settled before the record ends.
        """
        recording = recording.resampled()
        settled = 1 if self.alpha == 1.0 else math.ceil(math.log(TOLERANCE) / math.log(1.0 - self.alpha))
        valid = _inner(recording, settled, 1)
        return _derive(recording, lambda x: exponential_moving_average(x, self.alpha), valid, accuracy=2)

    def filter(self, x: FloatArray, rate: float) -> FloatArray:
        """Smooth torques like the angles."""
        return exponential_moving_average(x, self.alpha)

    def independence(self, rate: float) -> float:
        """Σ h² of the average, α / (2 − α)."""
        return self.alpha / (2.0 - self.alpha)


def _derive(
    recording: Recording, smooth: Callable[[FloatArray], FloatArray], valid: slice, accuracy: Accuracy
) -> Kinematics:
    """Smooth what was recorded and derive the rest from q.

    The acceleration comes from q even where v was recorded: drives filter the velocity they report, and a lag of 1 ms
    costs more than the noise of a second difference (measured on the DFKI double pendulum).
    """
    rate, q = recording.sample_rate, smooth(recording.q)
    v = central_difference(q, rate, accuracy) if recording.v is None else smooth(recording.v)
    a = second_difference(q, rate, accuracy) if recording.a is None else smooth(recording.a)
    return Kinematics(q, v, a, valid)


def _inner(recording: Recording, head: int, tail: int) -> slice:
    """Return the rows between the ends, or refuse a recording that consists of ends."""
    samples = len(recording)
    if samples <= head + tail:
        raise ExoidError(
            f"{samples} samples are too few: the filters spoil {head} at the beginning and {tail} at the end",
            where=recording.source.name if recording.source else "",
            remedy="record longer or choose a higher cut-off",
        )
    return slice(head, samples - tail)
