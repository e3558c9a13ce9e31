"""Fits of models whose friction depends on the torque of the rigid bodies, which is not known beforehand."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import NotIdentifiableError
from exoid.regression.least_squares import ROUNDING, TINY, factorize, scaled_lstsq, stack
from exoid.torques.linearised import Linearised

from .estimators import Estimator
from .estimators.by_name import fit_linear
from .problem import Fitted, Problem

STEPS = 8  # steps at most, of least squares and then of the estimator asked for
SETTLED = 1e-3  # they have settled when predictions change by less than this part of the residual


def fit_under_load(given: Problem, estimator: Estimator) -> Fitted:
    """Solve for a linearised model again and again: by weighted least squares, then by the estimator asked for."""
    values, change = _start(given), np.inf
    for _ in range(STEPS):
        problem = given.changed(model=Linearised.of(given.single.model, values))
        fit = fit_linear(problem, estimator).fit
        before, values = values, fit.solution.values
        moved = values - before
        # or when nothing moves by more than a tenth of its standard deviation and, without noise, a part of itself
        if (np.abs(moved) <= 0.1 * np.sqrt(np.diag(fit.solution.covariance)) + 1e-6 * np.abs(before)).all():
            change = 0.0
            break
        table = stack(problem.r_factors, fit.weights).R
        left = np.linalg.norm(table @ np.append(values, -1.0)) + ROUNDING * np.linalg.norm(table[:, -1]) + TINY
        change = float(np.linalg.norm(table[:, :-1] @ moved) / left)
        if change <= SETTLED:
            break
    # After the last step, a warning is due if predictions still change by more than this part of the residual
    unsettled = () if change <= 0.02 else (f"the fit has not settled in {STEPS} steps: leave some terms out",)
    return Fitted(problem, fit, (given.single.model.loaded_by(values),), (*fit.warnings, *unsettled))


def _start(given: Problem) -> FloatArray:
    """Solve from no load on, rows of each joint over its torque, or over a hundredth of the largest one."""
    fixed = given.prior_knowledge.fixed_values(given.names)
    free, values = np.isnan(fixed), np.nan_to_num(fixed)
    count = int(free.sum())
    for _ in range(STEPS):
        problem = given.changed(model=Linearised.of(given.single.model, values))
        torques = np.array([np.linalg.norm(t.R[:, -1]) / np.sqrt(max(t.rows, 1)) for t in problem.r_factors])
        weights = 1.0 / np.maximum(torques, max(0.01 * torques.max(), TINY))
        R = stack(problem.r_factors, weights.tolist()).R
        R = factorize(np.column_stack([R[:, :-1][:, free], R[:, -1] - R[:, :-1][:, ~free] @ values[~free]]), 0, 0.0).R
        before, values = values, values.copy()
        # shortest where a column says nothing: friction under a load that is not yet known
        values[free] = scaled_lstsq(R[:count, :count], R[:count, -1])
        left = max(float(np.linalg.norm(R[count:, -1])), ROUNDING * float(np.linalg.norm(R[:, -1])))
        if np.linalg.norm(R[:count, :count] @ (values - before)[free]) <= SETTLED * left or left == 0.0:
            break
    columns = np.sqrt(sum(t.R**2 for t in problem.r_factors)).max(axis=0)
    loads = {name for block in given.single.model.blocks if block.term.loaded for name in block.names}
    loads -= set(given.prior_knowledge.known)
    # Columns of friction under load below this part of the torque count as zero
    unloaded = [n for n, size in zip(given.names, columns, strict=False) if n in loads and size <= 1e-6 * columns[-1]]
    if unloaded:
        what = f"{', '.join(unloaded)} left no trace in the torque: there is no rigid-body torque to depend on"
        raise NotIdentifiableError(what, remedy="leave out LoadFriction at these joints", parameters=tuple(unloaded))
    return values
