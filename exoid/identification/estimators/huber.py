"""Robust least squares after Huber."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.regression.fit import has_torque, noise_floor, wls
from exoid.regression.least_squares import RFactor, factorize, joint_table, stack
from exoid.regression.problem import Fit, RowProblem
from exoid.signals.cutoff import robust_std

TUNING = 1.345  # residuals of this many standard deviations start to count less; 95 % efficient for normal noise


def huber(problem: RowProblem) -> Fit:
    """Minimise Σ ρ(r) over residuals r = (τ − W β) / s of each joint, ρ quadratic up to 1.345 and linear beyond.

    s is 1.4826 times the median of the joint's absolute residuals. Solved by reweighting: rows count
    min(1, 1.345 / |r|). A spike of the torque sensor then pulls no more than a residual of 1.345 s.
    """
    solution, floor = wls(problem).solution, noise_floor(problem)
    scales, measured = np.full(len(problem.r_factors), np.nan), has_torque(problem)
    for _ in range(50):  # until no parameter moves by more than this part of its standard deviation
        sizes: list[list[FloatArray]] = [[] for _ in problem.r_factors]
        for index, columns, table, _ in _tables(problem):
            sizes[index].append(np.abs(table[-1] - solution.values[columns] @ table[:-1]))
        left = np.maximum(np.array([robust_std(np.hstack(x)) if any(map(len, x)) else 0.0 for x in sizes]), floor)
        scales = np.where(measured | np.isnan(scales), left, scales)
        r_factors = _weighted(problem, solution.values, scales, lambda r: np.sqrt(TUNING / np.maximum(r, TUNING)))
        before, solution = solution, problem.solve(stack(r_factors))
        if (np.abs(solution.values - before.values) <= 1e-4 * np.sqrt(np.diag(solution.covariance))).all():
            break
    # ψ'(r) is 1 inside and 0 beyond: the inverse of Σ ψ' xᵀx takes the place of (WᵀW)⁻¹
    inside = _weighted(problem, solution.values, scales, lambda r: (r <= TUNING).astype(np.float64))
    bread = problem.solve(stack(inside))
    solution = solution._replace(
        inverse=bread.inverse, prior_noise=bread.prior_noise, condition_number=bread.condition_number
    )
    return Fit(solution, [1.0 / scale for scale in scales], TUNING)


def _weighted(
    problem: RowProblem, values: FloatArray, scales: FloatArray, weigh: Callable[[FloatArray], FloatArray]
) -> list[RFactor]:
    """R factors of rows over their scale, each with a weight by its absolute residual in units of the scale."""
    found: list[list[RFactor]] = [[] for _ in scales]
    count = len(problem.names)
    for index, columns, table, independent_fraction in _tables(problem):
        r = np.abs(table[-1] - values[columns] @ table[:-1]) / scales[index]
        r_factor = factorize((table * (weigh(r) / scales[index])).T, len(r), len(r) * independent_fraction)
        found[index] = [stack([*found[index], r_factor.among(np.append(columns, count), count + 1)])]
    return [r_factor for one in found for r_factor in one]


def _tables(problem: RowProblem) -> Iterator[tuple[int, NDArray[np.intp], FloatArray, float]]:
    """Go over usable rows [W τ] joint by joint: place among the R factors, parameters, rows, independent fraction."""
    for kind, rows, first in problem.blocks():
        for joint in range(rows.tau.shape[1]):
            place, (_, table) = problem.weight_index(kind, first + joint), joint_table(rows, joint)
            yield place, problem.columns[first + joint], table, rows.independent_fraction
