"""Preparations: ways from a recording to the kinematics and filtered torques that identification uses."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any, ClassVar, Protocol

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError, UnreadableInputError, nearest
from exoid.tools.json_values import record
from exoid.tools.numbers import checked

from .differentiation import Accuracy, Kinematics, difference, motion_edge, smooth_motion
from .filters.low_pass import TOLERANCE, design_frequency, noise_bandwidth, zero_phase
from .filters.parallel import ParallelFilter
from .recording import Recording

KINEMATICS_MULTIPLE = 2.0
"""Default cut-off of the kinematics filter over that of the parallel filter.

The parallel filter acts on torques and columns alike and causes no bias. The kinematics filter acts on q, inside sines
and products, and causes bias. With order 4 and twice the cut-off, its gain at the cut-off of the parallel filter is
0.998. The noise of an acceleration grows with the cut-off to the power 5/2.
"""
LARGEST_RATIO = 0.4
"""Largest default cut-off of the kinematics filter over the sampling rate."""


class Preparation(Protocol):
    """Interface of a preparation, which filters neither torques nor columns unless it says how.

    A recording with uneven time stamps is resampled first: rows of results are those of ``recording.resampled()``. Only
    estimates that were prepared by a preparation of exoid can be saved.

    Attributes:
        name: Short name.
    """

    name: ClassVar[str]

    def kinematics(self, recording: Recording) -> Kinematics:
        """Smooth the motion, and derive what was not recorded.

        Args:
            recording: The recording.

        Returns:
            Kinematics at the samples of ``recording.resampled()``.

        Raises:
            ExoidError: A cut-off is not below half the rate, time has a gap, or the ends leave no rows.
        """
        ...

    def filter(self, x: FloatArray, rate: float) -> FloatArray:
        """Filter measured torques.

        Args:
            x: Measured torques [N·m], (N, ...).
            rate: Sampling rate [Hz].

        Returns:
            Filtered torques [N·m], of the shape of ``x``.
        """
        return x

    def parallel(self, rate: float) -> ParallelFilter | None:
        """Return the filter of `filter` that regressor columns pass, too, and that can run on any segment.

        Args:
            rate: Sampling rate [Hz].

        Returns:
            The filter; None if columns are not filtered, or `kinematics` did so.
        """
        return None

    def independent_fraction(self, rate: float) -> float:
        """Compute the fraction of the filtered samples that carries independent noise.

        Args:
            rate: Sampling rate [Hz].

        Returns:
            Fraction of the samples, between 0 and 1.
        """
        return 1.0


def derive(
    recording: Recording, smooth: Callable[[FloatArray], FloatArray], ends: tuple[int, int], accuracy: Accuracy
) -> Kinematics:
    """Smooth the recorded quantities and derive the others from q; rows at both ends are not valid."""
    (head, tail), samples = ends, len(recording)
    if samples <= head + tail:
        raise UnreadableInputError(
            f"{samples} samples are too few: the filters distort {head} at the beginning and {tail} at the end",
            where=recording.file_name,
            remedy="record longer or choose a higher cut-off; of a longer log, pass all with Recording.segments",
        )
    # The acceleration is derived from q even if v was recorded, because drives filter the velocity they report. On the
    # DFKI double pendulum, a delay of 1 ms costs more accuracy than the noise of a second difference.
    rate, q = recording.sample_rate, smooth(recording.q)
    v = difference(q, rate, 1, accuracy) if recording.v is None else smooth(recording.v)
    a = difference(q, rate, 2, accuracy) if recording.a is None else smooth(recording.a)
    return Kinematics(q, v, a, slice(head, samples - tail))


@dataclass(frozen=True)
class ZeroPhase(Preparation):
    """Smooth the angles without delay, derive, then filter columns and torques alike.

    q, and v and a if recorded, are low-passed at the kinematics cut-off. Central differences over five points give what
    was not recorded (with three points the velocity of a 2 Hz motion at 50 Hz loses 1 %, with five 0.01 %). Then the
    *parallel filter* at ``cutoff`` acts on columns and torques: it removes noise from both sides of τ = W β, and the
    equation still holds. It acts on valid rows only, as if both sides of the equation were zero elsewhere. Rows in
    which the ends of the record affect q, v or a are not valid, see :func:`exoid.signals.motion_edge`.

    Attributes:
        cutoff: −3 dB frequency of the parallel filter [Hz].
        kinematics_cutoff: −3 dB frequency for q, v, a [Hz]; None for ``min(2 cutoff, 0.4 rate)``.

    Raises:
        ExoidError: A cut-off is not positive.
    """

    name: ClassVar[str] = "zero-phase"
    cutoff: float = 8.0
    kinematics_cutoff: float | None = None

    def __post_init__(self) -> None:
        checked(self.cutoff, "cutoff [Hz]", above=0.0, ndim=0)
        if self.kinematics_cutoff is not None:
            checked(self.kinematics_cutoff, "kinematics_cutoff [Hz]", above=0.0, ndim=0)

    def kinematics_cutoff_at(self, rate: float) -> float:
        """Compute the cut-off frequency of the kinematics filter.

        Args:
            rate: Sampling rate [Hz].

        Returns:
            −3 dB frequency for q, v, a [Hz].
        """
        return self.kinematics_cutoff or min(KINEMATICS_MULTIPLE * self.cutoff, LARGEST_RATIO * rate)

    def edge(self, rate: float) -> int:
        """Count the rows at each end that are not valid: one period of the kinematics cut-off.

        Args:
            rate: Sampling rate [Hz].

        Returns:
            Number of rows at each end.

        Raises:
            ExoidError: A cut-off is not below half the rate.
        """
        design_frequency(rate, self.cutoff)  # refuses a cut-off that the rate cannot carry
        return motion_edge(rate, self.kinematics_cutoff_at(rate))

    def kinematics(self, recording: Recording) -> Kinematics:
        """Smooth at the kinematics cut-off, and derive."""
        recording = recording.resampled()
        rate = recording.sample_rate
        cutoff, edge = self.kinematics_cutoff_at(rate), self.edge(rate)
        return derive(recording, lambda x: smooth_motion(x, rate, cutoff), (edge, edge), accuracy=4)

    def filter(self, x: FloatArray, rate: float) -> FloatArray:
        """Low-pass torques at ``cutoff``; memory beyond the result does not grow with ``x``."""
        return zero_phase(x, rate, self.cutoff)

    def parallel(self, rate: float) -> ParallelFilter:
        """Return the low-pass at ``cutoff``."""
        return ParallelFilter(rate, self.cutoff)

    def independent_fraction(self, rate: float) -> float:
        """Compute the noise bandwidth of the parallel filter over half the rate."""
        return noise_bandwidth(rate, self.cutoff)


@dataclass(frozen=True)
class Smoothed(Preparation):
    """Smooth the angles without delay and derive, but do not filter columns and torques.

    This preparation is for joints with stick-slip: a filter after sgn(v) would smear the jump of friction over rows
    that the dead band of :class:`exoid.torques.Coulomb` leaves out.

    Attributes:
        cutoff: −3 dB frequency for q, v, a [Hz].
    """

    name: ClassVar[str] = "smoothed"
    cutoff: float = 10.0

    def __post_init__(self) -> None:
        checked(self.cutoff, "cutoff [Hz]", above=0.0, ndim=0)

    def kinematics(self, recording: Recording) -> Kinematics:
        """Smooth and derive."""
        recording = recording.resampled()
        rate = recording.sample_rate
        edge = motion_edge(rate, self.cutoff)
        return derive(recording, lambda x: smooth_motion(x, rate, self.cutoff), (edge, edge), accuracy=4)


@dataclass(frozen=True)
class FiniteDifference(Preparation):
    """Central differences without a filter, as in doc. 1, sec. III-B; the first and last samples are dropped.

    Recorded velocities and accelerations are used unchanged.
    """

    name: ClassVar[str] = "finite-difference"

    def kinematics(self, recording: Recording) -> Kinematics:
        """Differentiate the angles."""
        return derive(recording.resampled(), lambda x: x, (1, 1), accuracy=2)


@dataclass(frozen=True)
class MovingAverage(Preparation):
    """Smooth every measured signal by an exponential moving average, as in doc. 2, sec. III.

    Differences of the smoothed angle give the velocity if none was recorded. All signals have the same delay of
    (1 − α)/α samples, which biases sines and products. Columns are formed from smoothed signals and not smoothed again.
    The last row, and rows until (1 − α)^k has fallen to a thousandth, are not valid.

    Attributes:
        alpha: Weight of the newest sample, 0 < α ≤ 1. Doc. 2 gives no value; 0.2 is an assumption.

    Raises:
        ExoidError: α is outside (0, 1].
    """

    name: ClassVar[str] = "moving-average"
    alpha: float = 0.2

    def __post_init__(self) -> None:
        checked(self.alpha, "alpha, the weight of the newest sample,", above=0.0, most=1.0, ndim=0)

    def kinematics(self, recording: Recording) -> Kinematics:
        """Smooth and derive."""
        settled = 1 if self.alpha == 1.0 else math.ceil(math.log(TOLERANCE) / math.log(1.0 - self.alpha))
        return derive(recording.resampled(), lambda x: self.filter(x, recording.sample_rate), (settled, 1), accuracy=2)

    def filter(self, x: FloatArray, rate: float) -> FloatArray:
        """Smooth torques like the angles, y_k = α x_k + (1 − α) y_{k−1} from y_0 = x_0."""
        smoothed, _ = scipy.signal.lfilter(
            [self.alpha], [1.0, self.alpha - 1.0], x, axis=0, zi=(1 - self.alpha) * x[:1]
        )
        return np.asarray(smoothed, dtype=np.float64)

    def independent_fraction(self, rate: float) -> float:
        """Compute Σ h² of the average, α / (2 − α)."""
        return self.alpha / (2.0 - self.alpha)


PREPARATIONS: dict[str, type[Preparation]] = {
    kind.name: kind for kind in (FiniteDifference, MovingAverage, Smoothed, ZeroPhase)
}
"""Types of preparation by name, for files and the command line."""


def preparation_to_json(preparation: Preparation) -> dict[str, Any]:
    """Describe a preparation by its name and settings."""
    if PREPARATIONS.get(preparation.name) is not type(preparation):
        what = f"{type(preparation).__name__} has no name in files"
        raise BadArgumentError(what, remedy=f"use one of {', '.join(PREPARATIONS)}")
    return {"name": preparation.name, **asdict(preparation)}  # type: ignore[call-overload]


def preparation_from_json(data: Mapping[str, Any]) -> Preparation:
    """Make a preparation from its description."""
    name = data.get("name")
    if name not in PREPARATIONS:
        some = f"{nearest(str(name), PREPARATIONS)}use one of {', '.join(PREPARATIONS)}"
        raise BadArgumentError(f"no preparation {name!r}", remedy=some)
    settings = {key: value for key, value in data.items() if key != "name"}
    try:
        return record(PREPARATIONS[name], settings)
    except (TypeError, ValueError, LookupError, OverflowError) as error:
        what = f"the preparation {name!r} does not take {settings} ({error})"
        raise BadArgumentError(what, remedy="identify again, and save") from error
