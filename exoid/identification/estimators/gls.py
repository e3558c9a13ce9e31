"""Feasible generalised least squares."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.regression.fit import Fit, wls
from exoid.regression.least_squares import RFactor, Solution, factorize, stack
from exoid.regression.problem import RowProblem
from exoid.regression.residuals import Noises, Point, Series, fit_noise, sandwich, series, settled

ROUNDS = 6  # noise and parameters are estimated in turn at most so often
DISAGREEMENT = 0.05  # probability with which GLS and WLS would be said to disagree although both are right


def gls(problem: RowProblem) -> Fit:
    """Whiten each joint's rows by an autoregressive model of its noise, and solve; in turn, until both settle.

    Of all unbiased linear estimators the one of smallest variance, *if* the residual is noise beside a right model. If
    it is the model's own error, whitening stresses the frequencies at which the model is worst: the point then leaves
    that of weighted least squares by more than noise explains, and the fit carries a remark.

    A warning says where it leaves weighted least squares by more than noise explains.
    """
    first = wls(problem)
    reference = sandwich(problem, first.point, first.solution)
    solution, noises = first.solution._replace(covariance=reference.covariance), _unbiased(reference.noises)
    for _ in range(ROUNDS):
        before, solution = solution, _solve(problem, first.point, noises)
        noises = _unbiased(fit_noise(problem, Point(solution.values, first.weights), solution.covariance))
        moved = np.abs(solution.values - before.values) > 1e-3 * np.sqrt(np.diag(solution.covariance))
        if settled(before.covariance, solution.covariance) and not moved.any():
            break
    warnings = _disagreement(problem.names, solution.values - first.solution.values, reference.covariance)
    return Fit(solution, first.weights, noises=noises, warnings=warnings, whitened=True)


def _unbiased(noises: Noises) -> Noises:
    """Count the p samples' worth of noise that its model has explained away: σ² N / (N − p)."""
    return {
        key: noise.scaled(noise.samples / max(noise.samples - noise.order, 1.0)) if noise.order else noise
        for key, noise in noises.items()
    }


def _solve(problem: RowProblem, point: Point, noises: Noises) -> Solution:
    """Solve with the rows of every uninterrupted run of samples whitened."""
    count = len(problem.names)
    total: RFactor | None = None
    before: dict[int, FloatArray] = {}
    for part in series(problem, point._replace(values=np.zeros(count))):
        rows = np.vstack([part.X, part.residual])
        past = rows[:, :0] if part.begins else before[part.joint]
        found = [] if total is None else [total]
        for start, stop in _runs(part.usable):
            past = past if start == 0 else rows[:, :0]
            found.append(_whitened(part, np.hstack([past, rows[:, start:stop]]), past.shape[1], noises, count))
        before[part.joint] = _unfinished(part.usable, past, rows, noises[part.kind, part.joint].order)
        total = stack(found) if found else total
    assert total is not None
    solution = problem.solve(total)
    return solution._replace(covariance=solution.inverse)


def _whitened(part: Series, rows: FloatArray, known: int, noises: Noises, count: int) -> RFactor:
    """Triangle of the rows of a run, of which the first were counted before and only tell where the noise was."""
    white = noises[part.kind, part.joint].whiten(rows)[:, known:]
    table = np.zeros((white.shape[1], count + 1))
    table[:, [*part.columns, count]] = white.T
    return factorize(table, len(table), float(len(table)))


def _unfinished(usable: FloatArray, past: FloatArray, rows: FloatArray, order: int) -> FloatArray:
    """Return the end of a run that may go on in the next stretch: as many samples as the noise remembers."""
    gaps = np.flatnonzero(usable == 0.0)
    run = rows[:, gaps[-1] + 1 :] if len(gaps) else np.hstack([past, rows])
    return run[:, max(0, run.shape[1] - order) :].copy()


def _runs(usable: FloatArray) -> Iterator[tuple[int, int]]:
    """Where runs of samples that are not left out start and stop."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0.0], usable, [0.0]])))
    return ((int(start), int(stop)) for start, stop in zip(edges[::2], edges[1::2], strict=True))


def _disagreement(names: Sequence[str], difference: FloatArray, covariance: FloatArray) -> tuple[str, ...]:
    """Compare with weighted least squares, whose variance bounds that of the difference (Hausman)."""
    limit = scipy.stats.norm.ppf(1.0 - 0.5 * DISAGREEMENT / len(names))
    far = [n for n, d, s in zip(names, difference, np.sqrt(np.diag(covariance)), strict=True) if abs(d) > limit * s]
    if not far:
        return ()
    return (
        f"gls and wls disagree on {', '.join(far)} by more than noise explains: "
        "the residual is model error, so prefer wls or huber",
    )
