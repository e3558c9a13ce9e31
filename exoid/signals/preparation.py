"""Preparations: ways from a recording to the kinematics and filtered torques that identification uses."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import ClassVar, Protocol

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .differentiation import Kinematics, derive, inner_samples, motion_edge, smooth_motion
from .filters import TOLERANCE, ParallelFilter, exponential_moving_average
from .recording import Recording


class Preparation(Protocol):
    """Interface of a preparation.

    A recording with uneven time stamps is resampled first: rows of results are those of ``recording.resampled()``. A
    preparation of another package is a frozen dataclass, whose fields are its settings; see
    :func:`exoid.signals.register_preparation`.
    """

    @property
    def name(self) -> str:
        """Short name."""
        ...

    def kinematics(self, recording: Recording) -> Kinematics:
        """Smooth the motion, and derive what was not recorded.

        Args:
            recording: The recording.

        Returns:
            Kinematics at the samples of ``recording.resampled()``.
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
        ...

    def filter_columns(self, x: FloatArray, rate: float) -> FloatArray:
        """Filter regressor columns like the torques, unless `kinematics` did so.

        Args:
            x: Columns, (N, ...).
            rate: Sampling rate [Hz].

        Returns:
            Filtered columns, of the shape of ``x``.
        """
        ...

    def parallel(self, rate: float) -> ParallelFilter | None:
        """Return the filter that both `filter` and `filter_columns` apply, if it can run on any segment.

        Args:
            rate: Sampling rate [Hz].

        Returns:
            The filter; None if torques are filtered from the first sample on and columns are not filtered.
        """
        ...

    def independent_fraction(self, rate: float) -> float:
        """Compute the fraction of the filtered samples that carries independent noise.

        Args:
            rate: Sampling rate [Hz].

        Returns:
            Fraction of the samples, between 0 and 1.
        """
        ...

    def describe(self) -> dict[str, float | str]:
        """Describe the preparation in a file.

        Returns:
            The settings, and ``"name"``.
        """
        ...


@dataclass(frozen=True)
class _Unfiltered:
    """Base class of the preparations without a parallel filter."""

    name: ClassVar[str]  # short name

    def filter(self, x: FloatArray, rate: float) -> FloatArray:
        """Return the torques unchanged."""
        return x

    def filter_columns(self, x: FloatArray, rate: float) -> FloatArray:
        """Return the columns unchanged."""
        return x

    def parallel(self, rate: float) -> None:
        """Return None, as there is no parallel filter."""

    def independent_fraction(self, rate: float) -> float:
        """Return 1, as torques are not filtered."""
        return 1.0

    def describe(self) -> dict[str, float | str]:
        """Describe the preparation in a file."""
        return {"name": self.name, **asdict(self)}


@dataclass(frozen=True)
class Smoothed(_Unfiltered):
    """Smooth the angles without delay and derive, but do not filter columns and torques.

    This preparation is for joints with stick-slip: a filter after sgn(v) would smear the jump of friction over rows
    that the dead band of :class:`exoid.torques.Coulomb` leaves out.

    Attributes:
        cutoff: −3 dB frequency for q, v, a [Hz].
        order: Order of one of the two passes.
    """

    name: ClassVar[str] = "smoothed"
    cutoff: float = 10.0
    order: int = 4

    def kinematics(self, recording: Recording) -> Kinematics:
        """Smooth and derive.

        Args:
            recording: The recording.

        Returns:
            Kinematics at the samples of ``recording.resampled()``.

        Raises:
            ExoidError: The cut-off is not below half the rate, time has a gap, or the ends leave no rows.
        """
        recording = recording.resampled()
        rate = recording.sample_rate
        edge = motion_edge(rate, self.cutoff, self.order)
        valid = inner_samples(recording, edge, edge)
        return derive(recording, lambda x: smooth_motion(x, rate, self.cutoff, self.order), valid, accuracy=4)


@dataclass(frozen=True)
class FiniteDifference(_Unfiltered):
    """Central differences without a filter, as in doc. 1, sec. III-B; the first and last samples are dropped.

    Recorded velocities and accelerations are used unchanged.
    """

    name: ClassVar[str] = "finite-difference"

    def kinematics(self, recording: Recording) -> Kinematics:
        """Differentiate the angles.

        Args:
            recording: The recording.

        Returns:
            Kinematics at the samples of ``recording.resampled()``.

        Raises:
            ExoidError: Time has a gap.
        """
        recording = recording.resampled()
        return derive(recording, lambda x: x, inner_samples(recording, 1, 1), accuracy=2)


@dataclass(frozen=True)
class MovingAverage(_Unfiltered):
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
        if not 0.0 < self.alpha <= 1.0:
            raise ExoidError(f"alpha is {self.alpha}", remedy="pass 0 < alpha ≤ 1, the weight of the newest sample")

    def kinematics(self, recording: Recording) -> Kinematics:
        """Smooth and derive.

        Args:
            recording: The recording.

        Returns:
            Kinematics at the samples of ``recording.resampled()``.

        Raises:
            ExoidError: Time has a gap, or the average has not settled before the record ends.
        """
        recording = recording.resampled()
        settled = 1 if self.alpha == 1.0 else math.ceil(math.log(TOLERANCE) / math.log(1.0 - self.alpha))
        valid = inner_samples(recording, settled, 1)
        return derive(recording, lambda x: exponential_moving_average(x, self.alpha), valid, accuracy=2)

    def filter(self, x: FloatArray, rate: float) -> FloatArray:
        """Smooth torques like the angles.

        Args:
            x: Measured torques [N·m], (N, ...).
            rate: Sampling rate [Hz].

        Returns:
            Smoothed torques [N·m], of the shape of ``x``.
        """
        return exponential_moving_average(x, self.alpha)

    def independent_fraction(self, rate: float) -> float:
        """Compute Σ h² of the average, α / (2 − α).

        Args:
            rate: Sampling rate [Hz].

        Returns:
            Fraction of the samples that carries independent noise.
        """
        return self.alpha / (2.0 - self.alpha)
