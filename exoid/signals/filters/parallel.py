"""The zero-phase low-pass at the requested rows only."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import ComplexArray, FloatArray

from .low_pass import edge_length, noise_bandwidth, zero_phase_modes


@dataclass(frozen=True)
class ParallelFilter:
    """Zero-phase Butterworth filter, as :func:`exoid.signals.zero_phase`, worked out at the requested rows only.

    Filtered rows are redundant: of 500 a second, filtered at 8 Hz, sixteen carry independent noise. Sums of squares and
    products over every :attr:`stride`-th row equal those over all rows, so only these are computed. The filter is
    linear and the same for all rows, so τ = W β still holds after both sides are filtered.

    Attributes:
        rate: Sampling rate [Hz].
        cutoff: −3 dB frequency [Hz].
    """

    rate: float
    cutoff: float

    @cached_property
    def reach(self) -> int:
        """Number of samples to each side that affect a filtered sample, beyond rounding."""
        return edge_length(self.rate, self.cutoff, tolerance=1e-15)  # below the rounding error of the filter

    @property
    def stride(self) -> int:
        """Decimation factor that loses no information."""
        # Four rows a row of independent noise: products of two filtered signals do not alias onto frequency zero
        return max(1, int(1.0 / (4.0 * noise_bandwidth(self.rate, self.cutoff))))

    def among_zeros(
        self, signals: Sequence[FloatArray] | FloatArray, rows: range, counted: NDArray[np.bool_] | None = None
    ) -> FloatArray:
        """Filter signals that are zero before and after, as samples that do not count are.

        Args:
            signals: Signals in any unit, K of (N,).
            rows: Requested samples, evenly spaced, R of them.
            counted: Mask of samples that count: others are taken for zero, (N,). None for all.

        Returns:
            Filtered signals at these samples, (K, R).
        """
        of_block, of_states, decays = _blocks(self, rows.step)
        size = len(of_block)
        begin, end = max(0, rows[0] - self.reach), min(len(signals[0]), rows[-1] + 1 + self.reach)
        lead = -(-(rows[0] - begin) // size)  # the first row begins a block
        wanted, behind = -(-len(rows) * rows.step // size), -(-(end - rows[0]) // size)
        padded = np.zeros((lead + max(wanted, behind), size))
        place = lead * size - rows[0]
        window = padded.reshape(-1)[place + begin : place + end]
        left_out = None if counted is None or counted[begin:end].all() else ~counted[begin:end]
        products = np.empty((len(padded), len(signals), of_block.shape[1]))
        for k, signal in enumerate(signals):  # one after the other, in the processor's cache
            window[:] = signal[begin:end]
            if left_out is not None:
                window[left_out] = 0.0
            np.matmul(padded, of_block, out=products[:, k])
        inside, modes = of_states.shape[1], len(decays)
        own = np.ascontiguousarray(products[..., inside:]).view(np.complex128)
        states = np.zeros_like(own)  # what the blocks before and after add
        for mode, decay in enumerate(decays):
            after, before = own[:-1, :, mode], own[:0:-1, :, modes + mode]  # Σ_j decay^(k−j) x_j over j ≤ k
            states[1:, :, mode] = scipy.signal.lfilter([1.0], [1.0, -decay], after, axis=0)
            states[:-1, :, modes + mode] = scipy.signal.lfilter([1.0], [1.0, -decay], before, axis=0)[::-1]
        filtered = (products[..., :inside] + states.view(np.float64) @ of_states)[lead : lead + wanted]
        return np.asarray(filtered.transpose(1, 0, 2).reshape(len(signals), -1)[:, : len(rows)])

    def gain(self, counted: NDArray[np.bool_], rows: range) -> FloatArray:
        """What becomes of ones at samples that count.

        Args:
            counted: Mask of samples that count, (N,).
            rows: Requested samples, R of them.

        Returns:
            Less than 1 near the ends of segments; 1 at samples that do not count, (R,).
        """
        ones = self.among_zeros(np.broadcast_to(1.0, (1, len(counted))), rows, counted)[0]
        return np.where(counted[rows.start : rows.stop : rows.step], ones, 1.0)


@lru_cache(maxsize=16)
def _blocks(filter_: ParallelFilter, step: int) -> tuple[FloatArray, FloatArray, ComplexArray]:
    """Matrices of a filter for blocks of B samples, at every ``step``-th of them."""
    # The impulse response is a sum of decaying modes, h_k = Re Σ c_i p_i^(|k| − 1) for k ≠ 0. What samples far from a
    # block add to its rows is therefore said by one complex number a mode and side, Σ x_j p_i^j, the *states*. Returned
    # are, with M rows a block, m modes, and real and imaginary parts one after the other: what samples of a block add
    # to its own rows, and to the states of the blocks after and before it, (B, M + 4 m); what states add to the rows of
    # a block, (4 m, M); and the factor of a state from block to block, (m,).
    poles, weights, middle = zero_phase_modes(filter_.rate, filter_.cutoff)
    rows = step * np.arange(max(1, round(128 / step)))
    size = len(rows) * step
    k = np.arange(size)
    response = np.append(middle, (poles ** k[:-1, np.newaxis] @ weights).real)
    own = response[np.abs(k[:, np.newaxis] - rows)]
    to_after, to_before = poles ** k[::-1, np.newaxis], poles ** k[:, np.newaxis]
    from_before, from_after = (weights * poles ** power[:, np.newaxis] for power in (rows, size - 1 - rows))
    parts = np.hstack([to_after, to_before]).view(np.float64)
    both = np.hstack([from_before, from_after])
    states = np.stack([both.real, -both.imag], axis=-1).reshape(len(rows), -1).T
    return np.hstack([own, parts]), np.ascontiguousarray(states), poles**size
