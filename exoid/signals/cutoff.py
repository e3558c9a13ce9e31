"""The cut-off of the parallel filter, from how far the motion stands out of the noise of the angles."""

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
"""Cut-offs that are compared [Hz]: below is motion, above nothing that a leg does."""

NOISE_SHARE = 0.02
"""Noise of the acceleration, over the acceleration, that rows may have, root mean square.

Noise in a column weakens its parameter by about the square of this: a share of 2 % by 0.04 %.
"""

UPPER_BAND = 0.6
"""From this part of half the sampling rate on, angles are taken to be noise."""

PIECE = 2**16
"""Longer recordings are looked at in pieces of so many samples."""

KEPT = 0.5
"""At least this part of each recording is to be left between the ends that filters spoil."""


class AccelerationPower(NamedTuple):
    """Sums of squared accelerations in a recording, up to each of the cut-offs, in the same unit, (71, n) each.

    Attributes:
        noise: Of the noise of the angles.
        total: Of the angles as they were recorded.
        samples: Of the recording.
        rate: [Hz].
    """

    noise: FloatArray
    total: FloatArray
    samples: int
    rate: float


def choose_cutoff(recordings: Iterable[Recording | Poses]) -> float:
    """Choose the highest cut-off [Hz] at which accelerations derived from noisy angles still are accelerations.

    White noise of power density N in an angle has ω⁴ N in the acceleration. N is the median of the periodogram P of the
    angle in the upper part of its band, over ln 2. For each joint, over all recordings, long ones piece by piece, noise
    and signal are compared below the cut-off f:

        Σ ∫₀ᶠ ω⁴ N ≤ 0.02² Σ ∫₀ᶠ ω⁴ P.

    Of the highest f of the joints the lowest counts, between 1 and 8 Hz; where there is none, the f where the noise has
    the smallest share. Ten times the density of noise lowers it by 10^(1/5). In short recordings it is raised until
    half of their samples are left between the ends.

    Args:
        recordings: From which to identify, all of the same joints; poses, and recordings that contain accelerations, do
            not count.
    """
    return cutoff_from([found for found in map(acceleration_power, recordings) if found is not None])


def acceleration_power(recording: Recording | Poses) -> AccelerationPower | None:
    """Compare noise and signal in a recording; None where its acceleration is not derived from angles.

    Raises:
        ExoidError: Time has a gap.
    """
    if isinstance(recording, Poses) or recording.a is not None:
        return None
    even = recording.resampled()
    pieces = [_sums(piece, even.sample_rate) for piece in np.array_split(even.q.T, -(-len(even) // PIECE), axis=1)]
    noise, total = (np.sum(sums, axis=0) for sums in zip(*pieces, strict=True))
    return AccelerationPower(noise, total, len(even), even.sample_rate)


def cutoff_from(bends: Sequence[AccelerationPower]) -> float:
    """Choose the cut-off [Hz] by what was found in each recording, see :func:`choose_cutoff`."""
    if not bends:
        return float(CUTOFFS[-1])
    noise, total = np.sum([each.noise for each in bends], axis=0), np.sum([each.total for each in bends], axis=0)
    share = noise / np.maximum(total, np.finfo(float).tiny)
    allowed = share <= NOISE_SHARE**2
    last = len(CUTOFFS) - 1 - np.argmax(allowed[::-1], axis=0)
    lowest = int(np.where(allowed.any(axis=0), last, np.argmin(share, axis=0)).min())
    long_enough = (cutoff for cutoff in CUTOFFS[lowest:] if all(_is_long(each, cutoff) for each in bends))
    return float(next(long_enough, CUTOFFS[-1]))


def _sums(q: FloatArray, rate: float) -> tuple[FloatArray, FloatArray]:
    """Sums of noise and of signal in a piece of a recording, (n, N)."""
    samples = q.shape[1]
    t = np.linspace(-1.0, 1.0, samples)
    level = np.ascontiguousarray(q)
    level = level - level.mean(axis=1, keepdims=True)
    level -= np.multiply.outer(level @ t / (t @ t), t)
    level *= np.hanning(samples)
    power = np.abs(scipy.fft.rfft(level)) ** 2 / samples
    frequency = scipy.fft.rfftfreq(samples, 1.0 / rate)
    noise = np.median(power[:, frequency >= UPPER_BAND * frequency[-1]], axis=1) / np.log(2.0)
    below = np.searchsorted(frequency, CUTOFFS, side="right") - 1
    slow = slice(0, below[-1] + 1)
    bend = (2.0 * np.pi * frequency[slow]) ** 4
    total = np.cumsum(bend * power[:, slow], axis=1)[:, below]
    return np.multiply.outer(np.cumsum(bend)[below], noise), total.T


def _is_long(bends: AccelerationPower, cutoff: float) -> bool:
    spoiled = 2 * ZeroPhase(cutoff).edge(bends.rate) if cutoff < 0.4 * bends.rate else bends.samples
    return spoiled <= (1.0 - KEPT) * bends.samples
