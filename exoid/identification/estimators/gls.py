"""Feasible generalised least squares."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.identification.least_squares import Solution, solve
from exoid.identification.problem import Problem
from exoid.identification.residuals import Noises, Point, Series, fit_noise, sandwich, series, settled
from exoid.identification.rows import Triangle, join, make_triangle

from .fit import Fit
from .wls import wls

ROUNDS = 6
"""Noise and parameters are estimated in turn at most so often."""

DISAGREEMENT = 0.05
"""Probability with which GLS and WLS would be said to disagree although both are right."""


def gls(problem: Problem) -> Fit:
    """Whiten each joint's rows by an autoregressive model of its noise, and solve; in turn, until both settle.

    Of all unbiased linear estimators the one of smallest variance, *if* the residual is noise beside a right model. If
    it is the model's own error, whitening stresses the frequencies at which the model is worst: the point then leaves
    that of weighted least squares by more than noise explains, and the fit carries a remark.
    """
    first = wls(problem)
    reference = sandwich(problem, first.point, first.solution.inverse, first.solution.covariance)
    solution, noises = first.solution._replace(covariance=reference.covariance), reference.noises
    for _ in range(ROUNDS):
        before, solution = solution, _solve(problem, first.point, noises)
        noises = fit_noise(problem, Point(solution.values, first.weights), solution.covariance)
        moved = np.abs(solution.values - before.values) > 1e-3 * np.sqrt(np.diag(solution.covariance))
        if settled(before.covariance, solution.covariance) and not moved.any():
            break
    remarks = _disagreement(problem.names, solution.values - first.solution.values, reference.covariance)
    return Fit(solution, first.weights, noises=noises, remarks=remarks)


def _solve(problem: Problem, point: Point, noises: Noises) -> Solution:
    """Solve with the rows of every uninterrupted stretch whitened."""
    triangles = [
        _whitened(part, rows, noises, len(problem.names))
        for part in series(problem, point._replace(values=np.zeros(len(problem.names))))
        for rows in _stretches(part.usable)
    ]
    solution = solve(join(triangles), problem.names)
    return solution._replace(covariance=solution.inverse)


def _whitened(part: Series, rows: slice, noises: Noises, count: int) -> Triangle:
    noise = noises[part.kind, part.joint]
    table = np.zeros((rows.stop - rows.start, count + 1))
    table[:, part.columns] = noise.whiten(part.X[:, rows]).T
    table[:, -1] = noise.whiten(part.residual[None, rows])[0]
    return make_triangle(table, len(table), float(len(table)))


def _stretches(usable: FloatArray) -> Iterator[slice]:
    """Slices of samples in a row that are not left out."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0.0], usable, [0.0]])))
    return (slice(int(start), int(stop)) for start, stop in zip(edges[::2], edges[1::2], strict=True))


def _disagreement(names: tuple[str, ...], difference: FloatArray, covariance: FloatArray) -> tuple[str, ...]:
    """Compare with weighted least squares, whose variance bounds that of the difference (Hausman)."""
    limit = scipy.stats.norm.ppf(1.0 - 0.5 * DISAGREEMENT / len(names))
    far = [n for n, d, s in zip(names, difference, np.sqrt(np.diag(covariance)), strict=True) if abs(d) > limit * s]
    if not far:
        return ()
    return (
        f"gls and wls disagree on {', '.join(far)} by more than noise explains: "
        "the residual is model error, so prefer wls or huber",
    )
