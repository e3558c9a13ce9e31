"""Trends of residuals with velocity or angle beyond the noise: errors of the friction or gravity model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import partial
from typing import Literal, NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray

from .least_squares import Solution
from .noise import QuadraticForm
from .problem import RowProblem
from .residuals import Noises, Point, Series, over_recordings
from .row_data import NoiseKind

BINS = 10
"""Equally filled intervals of velocity or angle in which residuals are averaged."""

QUANTILES = 1001
"""Of a longer recording so many values of velocity and angle stand for all, to find the intervals."""

SIGNIFICANT = 1e-3
"""A smaller probability is called a dependence,"""

NEGLIGIBLE = 0.01
"""unless its size is below this part of the joint's torque."""

LEFT = 1e-4
"""Of directions in which the fit has left less than this part of the noise, as an offset of the sum, none is tested."""

Against = Literal["velocity", "angle"]


@dataclass(frozen=True, eq=False)
class Trend:
    """Mean residual of a joint in intervals of its velocity or angle.

    Attributes:
        joint: Name.
        against: "velocity" [rad/s] or "angle" [rad].
        edges: Edges of the intervals, (B + 1,).
        mean: Residual, measured less predicted [N·m], (B,).
        std: Standard deviation of the mean if there were only noise, after the fit [N·m], (B,).
        p_value: Probability of means as large as these if there were only noise.
        share: Root mean square of the means over that of the joint's torque.
    """

    joint: str
    against: Against
    edges: FloatArray
    mean: FloatArray
    std: FloatArray
    p_value: float
    share: float

    @property
    def significant(self) -> bool:
        """Whether the residual depends on it by more than noise explains."""
        return self.p_value < SIGNIFICANT

    @property
    def matters(self) -> bool:
        """Whether the residual depends on it by more than noise explains, and the dependence is not negligible."""
        return self.significant and self.share > NEGLIGIBLE


def residual_trends(
    problem: RowProblem, point: Point, noises: Noises, solution: Solution, covariance: FloatArray, *, whitened: bool
) -> dict[int, tuple[Trend, ...]]:
    """Average residuals in motion against velocity and angle, joint by joint."""
    # With e the noise, X the weighted rows and δ the error of the estimate, the residual is e − X δ. Of its
    # sums D over intervals, cov = D Γ Dᵀ − D Γ Xᵀ A X Dᵀ − (…)ᵀ + D Xᵀ C X Dᵀ with A = (XᵀX)⁻¹ and C the
    # covariance of the estimate; for rows that were whitened D Γ Dᵀ − D X C Xᵀ Dᵀ. The sums over cov follow χ².
    edges = _edges(problem, point)
    sums: dict[int, _Sums] = {}
    for of_recording in over_recordings(problem, point, partial(_sum_up, edges, noises)):
        for joint, found in of_recording.items():
            sums[joint] = found.plus(sums[joint]) if joint in sums else found
    trends = {}
    for joint, found in sorted(sums.items()):
        own = np.ix_(problem.columns[joint], problem.columns[joint])
        G = found.columns
        both = 0.0 if whitened else found.cross @ solution.inverse[own] @ G.T
        fitted = G @ covariance[own] @ G.T
        cov = found.noise - fitted if whitened else found.noise - both - np.transpose(both) + fitted
        trends[joint] = _trends(problem, point, joint, edges[joint], found, cov)
    return trends


def trend_warnings(trends: Sequence[Trend]) -> tuple[str, ...]:
    """Name the joints whose residuals depend on velocity or angle."""
    return tuple(
        f"the residual of {trend.joint} depends on its {trend.against} by more than noise explains (p = "
        f"{trend.p_value:.1g}, {trend.share:.1%} of its torque): {_HINT[trend.against]}"
        for trend in trends
        if trend.matters
    )


_HINT = {
    "velocity": "friction is not of the form of the terms",
    "angle": "gravity, a spring or the axis is not as in the model",
}


@dataclass
class _Sums:
    """Sums over the intervals of one joint, (2 B, …)."""

    residual: FloatArray
    count: FloatArray
    columns: FloatArray
    noise: FloatArray
    cross: FloatArray

    def plus(self, other: _Sums) -> _Sums:
        """Add the sums of other samples."""
        return _Sums(*(getattr(self, field.name) + getattr(other, field.name) for field in fields(self)))


def _sum_up(edges: Mapping[int, FloatArray], noises: Noises, parts: Iterator[Series]) -> dict[int, _Sums]:
    """Sum over the intervals, joint by joint, what one recording in motion has there."""
    sums: dict[int, _Sums] = {}
    forms: dict[int, QuadraticForm] = {}
    for part in parts:
        if part.joint not in edges or part.kind.at_rest:
            continue
        D = _indicators(part, edges[part.joint])
        if part.begins:
            forms[part.joint] = QuadraticForm(noises[part.kind, part.joint], len(D) + len(part.X))
            rows, columns = len(D), len(part.X)
            shapes = ((rows,), (rows,), (rows, columns), (rows, rows), (rows, columns))
            sums[part.joint] = _Sums(*(np.zeros(shape) for shape in shapes))
        forms[part.joint].add(np.vstack([D, part.X]))
        found = sums[part.joint]
        found.residual += D @ part.residual
        found.count += D.sum(axis=1)
        found.columns += D @ part.X.T
        if part.ends:
            form = forms[part.joint].total()
            found.noise += form[: len(D), : len(D)]
            found.cross += part.stands_for * form[: len(D), len(D) :]
    return sums


class _Spread(NamedTuple):
    """Velocities and angles of a joint in one recording, in ascending order, each for so many rows, (2, K)."""

    values: FloatArray
    stands_for: float


def _edges(problem: RowProblem, point: Point) -> dict[int, FloatArray]:
    """Edges of the intervals of velocity and angle of each joint that has enough rows in motion, (2, B + 1)."""
    seen: dict[int, list[_Spread]] = {}
    for of_recording in over_recordings(problem, point, _spreads):
        for joint, spread in of_recording.items():
            seen.setdefault(joint, []).append(spread)
    # Independent samples wanted in each on average
    rows = {joint: sum(one.values.shape[1] * one.stands_for for one in spreads) for joint, spreads in seen.items()}
    return {joint: _quantiles(spreads) for joint, spreads in seen.items() if rows[joint] >= 10 * BINS}


def _spreads(parts: Iterator[Series]) -> dict[int, _Spread]:
    """Sort the velocities and angles of the rows of one recording in motion, and keep at most so many."""
    seen: dict[int, list[FloatArray]] = {}
    for part in parts:
        if not part.kind.at_rest:
            seen.setdefault(part.joint, []).append(np.array([part.v, part.q])[:, part.usable > 0.0])
    spreads = {}
    for joint, several in seen.items():
        values = np.sort(np.concatenate(several, axis=1), axis=1)
        count = values.shape[1]
        if count > QUANTILES:
            values = values[:, np.linspace(0, count - 1, QUANTILES).round().astype(np.intp)]
        spreads[joint] = _Spread(values, count / max(values.shape[1], 1))
    return spreads


def _quantiles(spreads: Sequence[_Spread]) -> FloatArray:
    """Values that so many parts of all rows are below, (2, B + 1)."""
    values = np.concatenate([spread.values for spread in spreads], axis=1)
    weights = np.concatenate([np.full(spread.values.shape[1], spread.stands_for) for spread in spreads])
    edges = []
    for of_one in values:
        order = np.argsort(of_one, kind="stable")
        share = np.cumsum(weights[order]) - 0.5 * weights[order]
        share = (share - share[0]) / (share[-1] - share[0])
        edges.append(np.interp(np.linspace(0.0, 1.0, BINS + 1), share, of_one[order]))
    return np.array(edges)


def _indicators(part: Series, edges: FloatArray) -> FloatArray:
    """Rows that are 1 where a usable sample is in an interval of velocity, then of angle, (2 B, N)."""
    D = np.zeros((2 * BINS, len(part.v)))
    for first, x, of_x in ((0, part.v, edges[0]), (BINS, part.q, edges[1])):
        place = np.clip(np.searchsorted(of_x, x, side="right") - 1, 0, BINS - 1)
        D[first + place, np.arange(len(x))] = part.usable
    return D


def _trends(
    problem: RowProblem, point: Point, joint: int, edges: FloatArray, found: _Sums, cov: FloatArray
) -> tuple[Trend, ...]:
    """Test the sums over intervals of velocity, and of angle."""
    place = problem.weight_index(NoiseKind(at_rest=False, rate_class=0), joint)
    weight, r_factor = point.weights[place], problem.r_factors[place]
    torque = float(np.linalg.norm(r_factor.R[:, -1])) / np.sqrt(max(r_factor.rows, 1))
    trends = []
    kinds: tuple[Against, ...] = ("velocity", "angle")
    for k, against in enumerate(kinds):
        rows = slice(k * BINS, (k + 1) * BINS)
        total, count = found.residual[rows], np.maximum(found.count[rows], 1.0)
        mean = total / count / weight
        share = float(np.sqrt(np.average(mean**2, weights=count))) / (torque or 1.0)
        std = np.sqrt(np.clip(np.diag(cov)[rows], 0.0, None)) / count / weight
        noise = np.sqrt(np.diag(found.noise)[rows])
        name = problem.joint_names[joint]
        trends.append(Trend(name, against, edges[k], mean, std, _p_value(total, cov[rows, rows], noise), share))
    return tuple(trends)


def _p_value(total: FloatArray, cov: FloatArray, noise: FloatArray) -> float:
    """Probability of sums as large as these, given what noise would make of each of them were nothing fitted."""
    scale = np.where(noise > 0.0, noise, 1.0)
    sizes, vectors = np.linalg.eigh(0.5 * (cov + cov.T) / np.multiply.outer(scale, scale))
    kept = sizes > LEFT
    if not kept.any():
        return 1.0
    statistic = float(np.sum((vectors[:, kept].T @ (total / scale)) ** 2 / sizes[kept]))
    return float(scipy.stats.chi2.sf(statistic, int(kept.sum())))
