"""What each recording contributes to an estimate, and how far it alone pulls the parameters."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .least_squares import stack
from .problem import RowProblem


class Influence(NamedTuple):
    """Influence of each of R recordings, in the order in which they were given.

    Attributes:
        recordings: Their names.
        change: Estimate without the recording less the estimate with it, in standard deviations of the latter;
            infinite where the others do not suffice, (R, P).
        share: Part of what is known of a parameter that comes from the recording, between 0 and 1; with the part of
            priors they add up to 1, (R, P).
        expected: Standard deviation of the change where all recordings are of the same leg; 0 where the others do not
            suffice, (R, P).
    """

    recordings: tuple[str, ...]
    change: FloatArray
    share: FloatArray
    expected: FloatArray

    def at(self, places: slice | NDArray[np.intp]) -> Influence:
        """Keep the parameters at these places.

        Args:
            places: Indices of parameters.

        Returns:
            Influence on these.
        """
        return Influence(self.recordings, *(array[:, places] for array in self[1:]))

    def strongest(self, limit: float | FloatArray) -> list[tuple[str, list[int]]]:
        """Name recordings that move parameters by more than so many standard deviations, one or (P,), and which.

        Only what noise does not explain either: in one of twenty estimates the largest change is that large by chance.

        Args:
            limit: Change in standard deviations, one number or (P,).

        Returns:
            Name of each such recording, and indices of the parameters that it moves.
        """
        chance = float(scipy.stats.norm.ppf(1.0 - 0.5 * 0.05 / self.change.size))
        moved = np.isfinite(self.change) & (np.abs(self.change) > np.maximum(limit, chance * self.expected))
        found = zip(self.recordings, moved, strict=True)
        return [(name, np.flatnonzero(row).tolist()) for name, row in found if row.any()]


def influence(problem: RowProblem, names: Sequence[str], weights: Sequence[float], std: FloatArray) -> Influence:
    """Leave out one recording after the other, with the weights of the whole."""
    # With A = Σ A_r the information WᵀW of all recordings, and of priors, the share of recording r in parameter
    # i is the part that its noise has in the variance, (A⁻¹ A_r A⁻¹)_ii / (A⁻¹)_ii. The change without it has
    # the variance ((A − A_r)⁻¹ − A⁻¹)_ii.
    each = problem.recording_r_factors(weights)
    whole = problem.solve(stack(each))
    change, share, expected = np.zeros((3, len(each), len(std)))
    for index, of_one in enumerate(each):
        try:
            values = problem.without(index, stack([*each[:index], *each[index + 1 :]]), whole)
        except ExoidError:
            values = np.full(len(std), np.inf)
        np.divide(values - whole.values, std, out=change[index], where=std > 0.0)
        share[index], expected[index] = _information(of_one.R[:, : len(std)], whole.inverse)
    return Influence(tuple(names), change, share, np.where(np.isfinite(change), expected, 0.0))


def _information(R: FloatArray, inverse: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Share of a recording with A_r = RᵀR, and standard deviation of the change without it, (P,) each."""
    # (A − A_r)⁻¹ − A⁻¹ = A⁻¹ Rᵀ (I − R A⁻¹ Rᵀ)⁻¹ R A⁻¹, so that both are sums over eigenvectors u of R A⁻¹ Rᵀ.
    sizes, vectors = np.linalg.eigh(R @ inverse @ R.T)
    parts = (inverse @ R.T @ vectors) ** 2
    variance = np.diag(inverse)
    parts = np.divide(parts.T, variance, out=np.zeros_like(parts.T), where=variance > 0.0)
    return parts.sum(axis=0), np.sqrt((parts.T / np.clip(1.0 - sizes, 1e-12, 1.0)).sum(axis=1))
