"""Fit of a torque model, linear in its parameters or not."""

from __future__ import annotations

from exoid.estimate.nonlinear import NO_NONLINEAR_PARAMETERS
from exoid.torques import TorqueModel

from .estimators import fit_by
from .fitting import Fitted, Start, Task
from .problem import Problem
from .variable_projection import search


def fit_model(task: Task, start: Start | None = None) -> Fitted:
    """Fit a model: by one call of the estimator where it is linear in all parameters, else by variable projection.

    Args:
        task: Torque model, data and estimator.
        start: Near the solution, such as that of nearly the same rows; None to search from the start values of the
            nonlinear parameters.

    Returns:
        The fit.

    Raises:
        ExoidError: Parameters are not determined by the rows: names them.
    """
    if any(term.nonlinear or term.loaded for term in task.terms):
        return search(task, start)
    models = tuple(TorqueModel(group.leg, task.terms) for group in task.groups)
    problem = Problem.of(task.groups, models, task.own, task.prior_knowledge, task.keep)
    problem.refuse_empty_joints()
    fit = fit_by(task.estimator, problem)
    return Fitted(models, fit.solution.values, NO_NONLINEAR_PARAMETERS, problem, fit, fit.warnings)
