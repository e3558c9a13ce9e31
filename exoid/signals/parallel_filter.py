"""Parallel filter: the same low-pass for both sides of τ = W β, computed only at the requested rows."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ComplexArray, FloatArray

from .filters import noise_bandwidth, reach, zero_phase_gain

OVERSAMPLING = 4.0
"""Rows per row of independent noise, so that products of two filtered signals do not alias onto frequency zero."""


@dataclass(frozen=True)
class ParallelFilter:
    """Zero-phase Butterworth filter, as :func:`exoid.signals.zero_phase`, by its gain in the frequency domain.

    Filtered rows are redundant: of 500 a second, filtered at 8 Hz, sixteen carry independent noise. Sums of squares and
    products over every :attr:`stride`-th row equal those over all rows, so only these are computed. The filter is
    linear and the same for all rows, so τ = W β still holds after both sides are filtered.

    Attributes:
        rate: Sampling rate [Hz].
        cutoff: −3 dB frequency [Hz].
        order: Order of one of the two passes.
    """

    rate: float
    cutoff: float
    order: int

    @cached_property
    def reach(self) -> int:
        """Number of samples to each side that affect a filtered sample, beyond rounding."""
        return reach(self.rate, self.cutoff, self.order)

    @cached_property
    def independent_fraction(self) -> float:
        """Fraction of the filtered samples that carries independent noise."""
        return noise_bandwidth(self.rate, self.cutoff, self.order)

    @property
    def stride(self) -> int:
        """Decimation factor that loses no information."""
        return max(1, int(1.0 / (OVERSAMPLING * self.independent_fraction)))

    def __call__(self, signals: FloatArray, rows: range) -> FloatArray:
        """Filter signals and decimate them to the requested rows.

        The signals are extended beyond their ends by point reflection.

        Args:
            signals: Signals in any unit, (K, N).
            rows: Requested samples, evenly spaced, R of them.

        Returns:
            Filtered signals at these samples, (K, R).
        """
        first, last, step = rows[0] - self.reach, rows[-1] + 1 + self.reach, rows.step
        beyond = max(0, -first), max(0, last - signals.shape[1])
        window = signals[:, max(0, first) : last]
        if any(beyond):
            window = np.pad(window, ((0, 0), beyond), mode="reflect", reflect_type="odd")
        # y = irfft(gain · rfft(x)) at every step-th sample: its spectrum is the whole one, aliased step times
        count = scipy.fft.next_fast_len(-(-window.shape[1] // (2 * step)), real=True)
        gain = _shifted_gain(self, 2 * step * count, self.reach)
        spectrum = scipy.fft.rfft(window, 2 * step * count, axis=1)
        spectrum *= gain
        return np.asarray(scipy.fft.irfft(_fold(spectrum, step), 2 * count, axis=1)[:, : len(rows)])


def _fold(spectrum: ComplexArray, step: int) -> ComplexArray:
    """Spectrum of every step-th sample: the mean over all frequencies that alias onto each other, (K, F)."""
    width = (spectrum.shape[1] - 1) // step  # half of the remaining samples
    folded = spectrum[:, : width + 1].copy()
    for k in range(1, step):  # parts of the spectrum alternate: upwards, then downwards and conjugated
        part = spectrum[:, k * width : (k + 1) * width + 1]
        folded += part if k % 2 == 0 else np.conj(part[:, ::-1])
    return folded / step


@lru_cache(maxsize=16)
def _shifted_gain(filter_: ParallelFilter, samples: int, early: int) -> ComplexArray:
    """Gain at the frequencies of an FFT of ``samples`` samples, times an advance by ``early`` samples."""
    turn = np.arange(samples // 2 + 1) / samples
    gain = zero_phase_gain(turn * filter_.rate, filter_.rate, filter_.cutoff, filter_.order)
    shifted: ComplexArray = gain * np.exp(2j * np.pi * turn * early)
    shifted.flags.writeable = False
    return shifted
