"""Zero-phase preparation (the parallel filter), and its cut-off frequency by the noise of the angles."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from functools import lru_cache
from typing import ClassVar, NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .base_pose import BasePose
from .differentiation import Kinematics, derive, inner_samples, motion_edge, smooth_motion
from .filters import ParallelFilter, design_frequency, zero_phase
from .poses import Poses
from .recording import Recording

KINEMATICS_MULTIPLE = 2.0
"""Default cut-off of the kinematics filter over that of the parallel filter.

The parallel filter acts on torques and columns alike and causes no bias. The kinematics filter acts on q, inside sines
and products, and causes bias. With order 4 and twice the cut-off, its gain at the cut-off of the parallel filter is
0.998. The noise of an acceleration grows with the cut-off to the power 5/2.
"""
LARGEST_RATIO = 0.4
"""Largest default cut-off of the kinematics filter over the sampling rate."""

CUTOFFS = np.linspace(1.0, 8.0, 71)
"""Cut-off frequencies that are compared [Hz]; legs do not move faster."""

NOISE_RATIO = 0.02
"""Largest noise-to-signal ratio of the acceleration (RMS).

Noise in a column attenuates its parameter by about the square of this ratio: 0.04 %.
"""

POSE_WEIGHT = 16.0
"""Weight of noise power where the motion of the base comes from a pose.

A base that a pose carries moves all masses, and its noise is in every column. Only what these columns do not share is
left for an inertia of the torso, so that the same noise attenuates it by more: by 0.3 % without this weight.
"""

UPPER_BAND = 0.6
"""Frequency above which angles are noise only, over half the sampling rate."""

SEGMENT = 2**16
"""Samples of one segment; longer recordings have several."""

KEPT = 0.5
"""Smallest fraction of a recording that the ends of the filters leave."""


@dataclass(frozen=True)
class ZeroPhase:
    """Smooth the angles without delay, derive, then filter columns and torques alike.

    q, and v and a if recorded, are low-passed at the kinematics cut-off. Central differences over five points give what
    was not recorded (with three points the velocity of a 2 Hz motion at 50 Hz loses 1 %, with five 0.01 %). Then the
    *parallel filter* at ``cutoff`` acts on columns and torques: it removes noise from both sides of τ = W β, and the
    equation still holds. It acts on valid rows only, as if both sides of the equation were zero elsewhere. Rows in
    which the ends of the record affect q, v or a are not valid, see :func:`exoid.signals.motion_edge`.

    Attributes:
        cutoff: −3 dB frequency of the parallel filter [Hz].
        kinematics_cutoff: −3 dB frequency for q, v, a [Hz]; None for ``min(2 cutoff, 0.4 rate)``.
        order: Order of one of the two passes of each filter.

    Raises:
        ExoidError: A cut-off is not positive.
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
        """Compute the cut-off frequency of the kinematics filter.

        Args:
            rate: Sampling rate [Hz].

        Returns:
            −3 dB frequency for q, v, a [Hz].
        """
        if self.kinematics_cutoff is not None:
            return self.kinematics_cutoff
        return min(KINEMATICS_MULTIPLE * self.cutoff, LARGEST_RATIO * rate)

    def edge(self, rate: float) -> int:
        """Count the rows at each end that are not valid: one period of the kinematics cut-off.

        Args:
            rate: Sampling rate [Hz].

        Returns:
            Number of rows at each end.

        Raises:
            ExoidError: A cut-off is not below half the rate.
        """
        design_frequency(rate, self.cutoff, self.order)  # refuses a cut-off that the rate cannot carry
        return motion_edge(rate, self.kinematics_cutoff_at(rate), self.order)

    def kinematics(self, recording: Recording) -> Kinematics:
        """Smooth and derive.

        Args:
            recording: The recording.

        Returns:
            Kinematics at the samples of ``recording.resampled()``.

        Raises:
            ExoidError: A cut-off is not below half the rate, time has a gap, or the ends leave no rows.
        """
        recording = recording.resampled()
        rate = recording.sample_rate
        cutoff = self.kinematics_cutoff_at(rate)
        valid = inner_samples(recording, self.edge(rate), self.edge(rate))
        return derive(recording, lambda x: smooth_motion(x, rate, cutoff, self.order), valid, accuracy=4)

    def filter(self, x: FloatArray, rate: float) -> FloatArray:
        """Low-pass torques at ``cutoff``; memory beyond the result does not grow with ``x``.

        Args:
            x: Measured torques [N·m], (N, ...).
            rate: Sampling rate [Hz].

        Returns:
            Filtered torques [N·m], of the shape of ``x``.

        Raises:
            ExoidError: The cut-off is not below half the rate, or there are too few samples.
        """
        return zero_phase(x, rate, self.cutoff, self.order)

    def filter_columns(self, x: FloatArray, rate: float) -> FloatArray:
        """Low-pass columns exactly as the torques.

        Args:
            x: Columns, (N, ...).
            rate: Sampling rate [Hz].

        Returns:
            Filtered columns, of the shape of ``x``.

        Raises:
            ExoidError: The cut-off is not below half the rate, or there are too few samples.
        """
        return self.filter(x, rate)

    def parallel(self, rate: float) -> ParallelFilter:
        """Return the low-pass at ``cutoff``.

        Args:
            rate: Sampling rate [Hz].

        Returns:
            The filter.
        """
        return ParallelFilter(rate, self.cutoff, self.order)

    def independent_fraction(self, rate: float) -> float:
        """Compute the noise bandwidth of the parallel filter over half the rate.

        Args:
            rate: Sampling rate [Hz].

        Returns:
            Fraction of the samples, between 0 and 1.

        Raises:
            ExoidError: The cut-off is not below half the rate.
        """
        return self.parallel(rate).independent_fraction

    def describe(self) -> dict[str, float | str]:
        """Describe the preparation in a file.

        Returns:
            The settings, and ``"name"``.
        """
        default = f"min({KINEMATICS_MULTIPLE:g} cutoff, {LARGEST_RATIO:g} rate)"
        return {"name": self.name, **asdict(self), "kinematics_cutoff": self.kinematics_cutoff or default}


class AccelerationPower(NamedTuple):
    """Power of the acceleration below each of :data:`CUTOFFS`, in a common unit."""

    noise: FloatArray  # power due to the noise of the angles, (71, n); one or two columns more for some bases
    total: FloatArray  # power of the recorded angles, as many columns
    samples: int  # number of samples
    rate: float  # sampling rate [Hz]


def choose_cutoff(recordings: Iterable[Recording | Poses], *, base_rows: bool = False) -> float:
    """Choose the highest cut-off frequency at which derived accelerations have little noise.

    White noise of power density N in an angle gives ω⁴ N in the acceleration. N is the median of the periodogram P of
    the angle in its upper band, over ln 2. For each joint, noise and signal below the cut-off f are compared over all
    segments of all recordings:

        Σ ∫₀ᶠ ω⁴ N ≤ 0.02² Σ ∫₀ᶠ ω⁴ P.

    The result is the smallest over the joints of the highest such f, between 1 and 8 Hz. If there is none for a joint,
    its f has the smallest noise ratio. For logs at 20 Hz or less that ask for a higher cut-off than their rate allows,
    f is 0.2 of the rate. Ten times the noise density lowers f by 10^(1/5). For short recordings f is raised until the
    ends of the filters leave half of the samples. A recording that contains accelerations counts with its length and
    its rate only. Where the base moves, noise and signal of its angular acceleration, ω² times those of its angular
    velocity about the axis that turns most, are added to those of each joint. The specific force counts by gravity, of
    which the noise of a usual accelerometer is less than 0.02.

    Where the base has rows of its own, its angular acceleration is the column of its inertia: it then counts by itself
    too.

    Args:
        recordings: Recordings to identify from, all of the same joints. Poses are ignored.
        base_rows: Whether rows of the base are identified from.

    Returns:
        Cut-off frequency [Hz].

    Raises:
        ExoidError: Time has a gap.
    """
    powers = (acceleration_power(recording, base_rows=base_rows) for recording in recordings)
    return cutoff_from([found for found in powers if found is not None])


def acceleration_power(recording: Recording | Poses, *, base_rows: bool = False) -> AccelerationPower | None:
    """Compute noise and signal power of the acceleration of a recording."""
    if isinstance(recording, Poses):
        return None
    even = recording.resampled()
    if recording.a is not None:
        nothing = np.zeros((len(CUTOFFS), len(recording.joint_names) + (base_rows and recording.base is not None)))
        return AccelerationPower(nothing, nothing, len(even), even.sample_rate)
    segments = np.array_split(even.q.T, -(-len(even) // SEGMENT), axis=1)
    powers = [_segment_power(segment, even.sample_rate) for segment in segments]
    noise, total = (np.sum(each, axis=0) for each in zip(*powers, strict=True))
    if even.base is not None and even.base.pose is not None:
        of_pose = _pose_power(even.base.pose, even.sample_rate)
        noise, total = (np.hstack(pair) for pair in zip((noise, total), of_pose, strict=True))
        noise = POSE_WEIGHT * noise
    elif even.base is not None:
        of_base = _base_power(even.base.angular_velocity.T, even.sample_rate)
        noise, total = noise + of_base[0], total + of_base[1]
        if base_rows:
            noise, total = np.hstack([noise, of_base[0]]), np.hstack([total, of_base[1]])
    return AccelerationPower(noise, total, len(even), even.sample_rate)


def _pose_power(pose: BasePose, rate: float) -> tuple[FloatArray, FloatArray]:
    """Powers of noise and signal of the acceleration of a pose, of position and quaternion, (71, 2) each."""
    segments = np.array_split(pose.columns.T, -(-len(pose) // SEGMENT), axis=1)
    powers = [_segment_power(segment, rate) for segment in segments]
    noise, total = (np.sum(each, axis=0) for each in zip(*powers, strict=True))
    return _by_part(noise), _by_part(total)


def _by_part(power: FloatArray) -> FloatArray:
    """Sum powers of the columns of a pose, (K, 7), over position and quaternion, (K, 2)."""
    return np.column_stack([power[:, :3].sum(axis=1), power[:, 3:].sum(axis=1)])


def _base_power(omega: FloatArray, rate: float) -> tuple[FloatArray, FloatArray]:
    """Powers of noise and signal of the base's angular acceleration about the axis that turns most, (71, 1) each."""
    segments = np.array_split(omega, -(-omega.shape[1] // SEGMENT), axis=1)
    powers = [_segment_power(segment, rate, derivatives=1) for segment in segments]
    noise, total = (np.sum(each, axis=0) for each in zip(*powers, strict=True))
    most = int(np.argmax(total[-1]))
    return noise[:, [most]], total[:, [most]]


def cutoff_from(powers: Sequence[AccelerationPower]) -> float:
    """Choose the cut-off frequency by the powers of each recording, see :func:`choose_cutoff`."""
    if not powers:
        return float(CUTOFFS[-1])
    noise, total = np.sum([each.noise for each in powers], axis=0), np.sum([each.total for each in powers], axis=0)
    ratio = noise / np.maximum(total, np.finfo(float).tiny)
    allowed = ratio <= NOISE_RATIO**2
    last = len(CUTOFFS) - 1 - np.argmax(allowed[::-1], axis=0)
    lowest = int(np.where(allowed.any(axis=0), last, np.argmin(ratio, axis=0)).min())
    long_enough = (cutoff for cutoff in CUTOFFS[lowest:] if all(_is_long(each, cutoff) for each in powers))
    return float(next(long_enough, highest_cutoff(min(each.rate for each in powers))))


def highest_cutoff(rate: float) -> float:
    """Highest cut-off: 8 Hz; below 20 samples a second, that at which both filters have their usual ratio."""
    if CUTOFFS[-1] < LARGEST_RATIO * rate:
        return float(CUTOFFS[-1])
    return LARGEST_RATIO / KINEMATICS_MULTIPLE * rate


def _segment_power(q: FloatArray, rate: float, derivatives: int = 2) -> tuple[FloatArray, FloatArray]:
    """Powers of noise and of signal in the derivative of a segment of a recording, (n, N)."""
    samples = q.shape[1]
    t = np.linspace(-1.0, 1.0, samples)
    detrended = np.ascontiguousarray(q)
    detrended = detrended - detrended.mean(axis=1, keepdims=True)
    detrended -= np.multiply.outer(detrended @ t / (t @ t), t)
    detrended *= _window(samples)
    spectrum = scipy.fft.rfft(detrended)
    power = (spectrum.real**2 + spectrum.imag**2) / samples
    frequency = scipy.fft.rfftfreq(samples, 1.0 / rate)
    noise = np.median(power[:, frequency >= UPPER_BAND * frequency[-1]], axis=1) / np.log(2.0)
    below = np.searchsorted(frequency, CUTOFFS, side="right") - 1
    slow = slice(0, below[-1] + 1)
    weight = (2.0 * np.pi * frequency[slow]) ** (2 * derivatives)
    total = np.cumsum(weight * power[:, slow], axis=1)[:, below]
    return np.multiply.outer(np.cumsum(weight)[below], noise), total.T


@lru_cache(maxsize=4)
def _window(samples: int) -> FloatArray:
    """Hann window of so many samples."""
    window = np.hanning(samples)
    window.flags.writeable = False
    return window


def _is_long(power: AccelerationPower, cutoff: float) -> bool:
    """Tell whether the ends of the filters leave enough of a recording."""
    distorted = 2 * ZeroPhase(cutoff).edge(power.rate) if cutoff < 0.4 * power.rate else power.samples
    return distorted <= (1.0 - KEPT) * power.samples
