"""Rows without what is not known about reversals: while a joint turns round, its friction follows no velocity.

A joint with sharp friction sticks at a reversal. Its friction is then what holds it, anywhere between −c0 and c0, and
no term says how much. Doc. 1, sec. III-G, leaves such samples out. Behind a low-pass they cannot be left out: the
filter has spread their torque over the rows around them. But it is linear. The friction that is not known is a
sum of pulses at the reversal, and behind the filter a sum of its impulse responses h:

    (h * τ)_k = (h * W)_k β + Σ_i p_i h(t_k − t_i).

Both sides are projected onto the complement of these pulses, which is the same as to fit every p_i. Pulses are so
close together that the filter could not tell more of them apart.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.signals import ParallelFilter

LONGEST = 1.0
"""A longer stay below the reversal speed is a rest [s]: its rows are kept."""

PIECE = 1024
"""Rows that are projected together."""

LARGEST_SHARE = 0.7
"""Share of the independent samples of a piece that pulses may take; where there are more, the rows stay."""

NEGLIGIBLE = 1e-6
"""Part of the largest response below which a response is over."""


def around_stops(slow: NDArray[np.bool_], parallel: ParallelFilter) -> NDArray[np.bool_]:
    """Widen the reversals of joints, and leave out rests.

    The kinematics filter has about twice the cut-off f of the parallel filter, and rounds the corner that a stop makes
    in the angle over 1 / (4π f).

    Args:
        slow: Whether each joint is slower than its reversal speed, (N, n).
        parallel: Filter of the rows.

    Returns:
        Whether the friction of each joint is unknown, (N, n).
    """
    widened = np.zeros_like(slow)
    grown = math.ceil(parallel.rate / (4.0 * math.pi * parallel.cutoff))
    for joint in range(slow.shape[1]):
        for start, end in _runs(slow[:, joint]):
            if end - start <= LONGEST * parallel.rate:
                widened[max(0, start - grown) : end + grown, joint] = True
    return widened


def without_reversals(
    signals: FloatArray, unknown: NDArray[np.bool_], rows: range, parallel: ParallelFilter
) -> FloatArray:
    """Project the filtered columns and torque of a joint onto the complement of the pulses at its reversals.

    Args:
        signals: Filtered signals at some samples, (K, R).
        unknown: Whether the friction of the joint is unknown, for all samples, (N,).
        rows: These samples, R of them.
        parallel: The filter.

    Returns:
        Projected signals, (K, R).
    """
    out, response = signals.copy(), _response(parallel)
    reach = len(response) // 2
    pulses = _pulses(unknown, parallel)
    for piece in np.array_split(np.arange(len(rows)), -(-len(rows) // PIECE)):
        k = rows.start + rows.step * piece
        near = pulses[(pulses >= k[0] - reach) & (pulses <= k[-1] + reach)]
        lag = k[:, None] - near
        B = np.where(np.abs(lag) <= reach, response[np.clip(lag + reach, 0, 2 * reach)], 0.0)
        independent = len(k) * min(1.0, parallel.independent_fraction * rows.step)
        if 0 < len(near) <= LARGEST_SHARE * independent:
            Q, _ = np.linalg.qr(B)
            out[:, piece] -= (out[:, piece] @ Q) @ Q.T
    return out


def _pulses(unknown: NDArray[np.bool_], parallel: ParallelFilter) -> NDArray[np.intp]:
    """Samples of the pulses: from end to end of each reversal, at most a quarter of the cut-off's period apart."""
    spacing = 0.25 * parallel.rate / parallel.cutoff
    found = [
        np.rint(np.linspace(start, end - 1, 1 + math.ceil((end - start) / spacing))) for start, end in _runs(unknown)
    ]
    return np.unique(np.concatenate([np.zeros(0), *found]).astype(np.intp))


def _runs(mask: NDArray[np.bool_]) -> NDArray[np.intp]:
    """First sample of each run, and the first behind it, (M, 2)."""
    return np.flatnonzero(np.diff(mask, prepend=False, append=False)).reshape(-1, 2)


@lru_cache(maxsize=16)
def _response(parallel: ParallelFilter) -> FloatArray:
    """Impulse response of the filter, its largest value in the middle, cut off where it is over, (2 M + 1,)."""
    reach = parallel.reach
    impulse = np.zeros((1, 2 * reach + 1))
    impulse[0, reach] = 1.0
    response = parallel(impulse, range(2 * reach + 1))[0]
    lasting = np.flatnonzero(np.abs(response) > NEGLIGIBLE * response.max())
    half = int(np.abs(lasting - reach).max())
    return np.asarray(response[reach - half : reach + half + 1])
