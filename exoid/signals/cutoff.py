"""Cut-off frequency of the parallel filter, chosen by the signal-to-noise ratio of the acceleration."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray

from .poses import Poses
from .preparation import ZeroPhase
from .recording import Recording

CUTOFFS = np.linspace(1.0, 8.0, 71)
"""Cut-off frequencies that are compared [Hz]; legs do not move faster."""

NOISE_RATIO = 0.02
"""Largest noise-to-signal ratio of the acceleration (RMS).

Noise in a column attenuates its parameter by about the square of this ratio: 0.04 %.
"""

UPPER_BAND = 0.6
"""Frequency above which angles are noise only, over half the sampling rate."""

SEGMENT = 2**16
"""Samples of one segment; longer recordings have several."""

KEPT = 0.5
"""Smallest fraction of a recording that the ends of the filters leave."""


class AccelerationPower(NamedTuple):
    """Power of the acceleration below each of :data:`CUTOFFS`, in a common unit.

    Attributes:
        noise: Power due to the noise of the angles, (71, n).
        total: Power of the recorded angles, (71, n).
        samples: Number of samples.
        rate: Sampling rate [Hz].
    """

    noise: FloatArray
    total: FloatArray
    samples: int
    rate: float


def choose_cutoff(recordings: Iterable[Recording | Poses]) -> float:
    """Choose the highest cut-off frequency at which derived accelerations have little noise.

    White noise of power density N in an angle gives ω⁴ N in the acceleration. N is the median of the periodogram P of
    the angle in its upper band, over ln 2. For each joint, noise and signal below the cut-off f are compared over all
    segments of all recordings:

        Σ ∫₀ᶠ ω⁴ N ≤ 0.02² Σ ∫₀ᶠ ω⁴ P.

    The result is the smallest over the joints of the highest such f, between 1 and 8 Hz. If there is none for a joint,
    its f has the smallest noise ratio. Ten times the noise density lowers f by 10^(1/5). For short recordings f is
    raised until the ends of the filters leave half of the samples.

    Args:
        recordings: Recordings to identify from, all of the same joints. Poses, and recordings that contain
            accelerations, are ignored.

    Returns:
        Cut-off frequency [Hz].

    Raises:
        ExoidError: Time has a gap.
    """
    return cutoff_from([found for found in map(acceleration_power, recordings) if found is not None])


def acceleration_power(recording: Recording | Poses) -> AccelerationPower | None:
    """Compute noise and signal power of the acceleration of a recording.

    Args:
        recording: The recording.

    Returns:
        Powers below each cut-off; None for poses, and for a recording that contains accelerations.

    Raises:
        ExoidError: Time has a gap.
    """
    if isinstance(recording, Poses) or recording.a is not None:
        return None
    even = recording.resampled()
    segments = np.array_split(even.q.T, -(-len(even) // SEGMENT), axis=1)
    powers = [_segment_power(segment, even.sample_rate) for segment in segments]
    noise, total = (np.sum(each, axis=0) for each in zip(*powers, strict=True))
    return AccelerationPower(noise, total, len(even), even.sample_rate)


def cutoff_from(powers: Sequence[AccelerationPower]) -> float:
    """Choose the cut-off frequency by the powers of each recording, see :func:`choose_cutoff`.

    Args:
        powers: Result of :func:`acceleration_power` for each recording; none gives the highest cut-off.

    Returns:
        Cut-off frequency [Hz].
    """
    if not powers:
        return float(CUTOFFS[-1])
    noise, total = np.sum([each.noise for each in powers], axis=0), np.sum([each.total for each in powers], axis=0)
    ratio = noise / np.maximum(total, np.finfo(float).tiny)
    allowed = ratio <= NOISE_RATIO**2
    last = len(CUTOFFS) - 1 - np.argmax(allowed[::-1], axis=0)
    lowest = int(np.where(allowed.any(axis=0), last, np.argmin(ratio, axis=0)).min())
    long_enough = (cutoff for cutoff in CUTOFFS[lowest:] if all(_is_long(each, cutoff) for each in powers))
    return float(next(long_enough, CUTOFFS[-1]))


def _segment_power(q: FloatArray, rate: float) -> tuple[FloatArray, FloatArray]:
    """Powers of noise and of signal in a segment of a recording, (n, N)."""
    samples = q.shape[1]
    t = np.linspace(-1.0, 1.0, samples)
    detrended = np.ascontiguousarray(q)
    detrended = detrended - detrended.mean(axis=1, keepdims=True)
    detrended -= np.multiply.outer(detrended @ t / (t @ t), t)
    detrended *= np.hanning(samples)
    power = np.abs(scipy.fft.rfft(detrended)) ** 2 / samples
    frequency = scipy.fft.rfftfreq(samples, 1.0 / rate)
    noise = np.median(power[:, frequency >= UPPER_BAND * frequency[-1]], axis=1) / np.log(2.0)
    below = np.searchsorted(frequency, CUTOFFS, side="right") - 1
    slow = slice(0, below[-1] + 1)
    weight = (2.0 * np.pi * frequency[slow]) ** 4
    total = np.cumsum(weight * power[:, slow], axis=1)[:, below]
    return np.multiply.outer(np.cumsum(weight)[below], noise), total.T


def _is_long(power: AccelerationPower, cutoff: float) -> bool:
    """Tell whether the ends of the filters leave enough of a recording."""
    distorted = 2 * ZeroPhase(cutoff).edge(power.rate) if cutoff < 0.4 * power.rate else power.samples
    return distorted <= (1.0 - KEPT) * power.samples
