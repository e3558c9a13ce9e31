"""What each recording contributes to an estimate, and how far it alone pulls the parameters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .estimators import Fit
from .problem import Problem
from .rows import Triangle, join

NO_ESTIMATE = np.inf
"""Change of a parameter that cannot be identified without a recording."""

SIGNIFICANT = 0.05
"""Probability with which one recording or other of the same leg would be said to move the estimate."""

TINY = 1e-12
"""Least share of the other recordings, to divide by."""


class Influence(NamedTuple):
    """Influence of each of R recordings, in the order in which they were given.

    Attributes:
        recordings: Their names.
        change: Estimate without the recording less the estimate with it, in standard deviations of the latter;
            infinite where the others do not suffice, (R, P).
        share: Part of what is known of a parameter that comes from the recording; they add up to 1 where there is no
            prior, (R, P).
    """

    recordings: tuple[str, ...]
    change: FloatArray
    share: FloatArray

    @property
    def expected(self) -> FloatArray:
        """Standard deviation of the change where all recordings are of the same leg, √(share / (1 − share)), (R, P)."""
        share = np.clip(self.share, 0.0, 1.0 - TINY)
        return np.asarray(np.sqrt(share / (1.0 - share)))

    def of(self, count: int) -> Influence:
        """Keep the first so many parameters."""
        return self.at(slice(count))

    def at(self, places: slice | NDArray[np.intp]) -> Influence:
        """Keep the parameters at these places."""
        return Influence(self.recordings, self.change[:, places], self.share[:, places])

    def strongest(self, limit: float | FloatArray) -> list[tuple[str, list[int]]]:
        """Name recordings that move parameters by more than so many standard deviations, one or (P,), and which.

        Only what noise does not explain either: in one of twenty estimates the largest change of all does by chance.
        """
        chance = float(scipy.stats.norm.ppf(1.0 - 0.5 * SIGNIFICANT / self.change.size))
        moved = np.isfinite(self.change) & (np.abs(self.change) > np.maximum(limit, chance * self.expected))
        found = zip(self.recordings, moved, strict=True)
        return [(name, np.flatnonzero(row).tolist()) for name, row in found if row.any()]


def influence(problem: Problem, names: Sequence[str], fit: Fit, std: FloatArray, count: int) -> Influence | None:
    """Leave out one recording after the other, with the weights of the whole.

    Args:
        problem: The problem.
        names: Of its recordings.
        fit: Its solution.
        std: Of the parameters.
        count: How many of them are wanted, P.

    Returns:
        Nothing for one recording.
    """
    if len(problem.data) < 2:
        return None
    each = [weighted(problem, index, fit.weights) for index in range(len(problem.data))]

    def without(_: int, others: Triangle) -> FloatArray:
        return problem.solve(others).values

    return leave_out(each, names, without, problem.solve(join(each)).values, fit.solution.inverse, std).of(count)


def leave_out(
    each: Sequence[Triangle],
    names: Sequence[str],
    without: Callable[[int, Triangle], FloatArray],
    whole: FloatArray,
    inverse: FloatArray,
    std: FloatArray,
) -> Influence:
    """Solve for the weighted rows of all recordings but one, each in turn.

    Args:
        each: Weighted rows of each recording, at least two.
        names: Of the recordings.
        without: Values for the rows of all recordings but one, given its index; infinite where there are none.
        whole: Values for all rows, (P,).
        inverse: (WᵀW)⁻¹ of all rows, (P, P).
        std: Of the parameters, (P,).
    """
    change, share = [], []
    for index, of_one in enumerate(each):
        W = of_one.R[:, : len(std)]
        share.append(np.einsum("ij,ji->i", inverse, W.T @ W))
        try:
            values = without(index, join([*each[:index], *each[index + 1 :]]))
        except ExoidError:
            change.append(np.full(len(std), NO_ESTIMATE))
            continue
        change.append(np.divide(values - whole, std, out=np.zeros(len(std)), where=std > 0.0))
    return Influence(tuple(names), np.array(change), np.array(share))


def influence_to_json(found: Influence | None, names: Sequence[str]) -> list[dict[str, Any]]:
    """Turn influences into what JSON can hold; what is infinite becomes null."""
    if found is None:
        return []
    return [
        {
            "recording": recording,
            "change": {n: float(x) if np.isfinite(x) else None for n, x in zip(names, change, strict=True)},
            "share": dict(zip(names, share.tolist(), strict=True)),
        }
        for recording, change, share in zip(*found, strict=True)
    ]


def influence_from_json(data: Sequence[dict[str, Any]], names: Sequence[str]) -> Influence | None:
    """Read what :func:`influence_to_json` wrote."""
    if not data:
        return None
    change = [[NO_ESTIMATE if one["change"][n] is None else one["change"][n] for n in names] for one in data]
    share = [[one["share"][n] for n in names] for one in data]
    return Influence(tuple(str(one["recording"]) for one in data), np.array(change), np.array(share))


def weighted(problem: Problem, index: int, weights: Sequence[float]) -> Triangle:
    """Triangle of all joints' rows of one recording."""
    at_rest, triangles = problem.at_rest(index), problem.each[index]
    return join(triangles, [weights[problem.place(at_rest, joint)] for joint in range(len(triangles))])
