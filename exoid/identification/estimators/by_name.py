"""Estimators by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from exoid.errors import BadArgumentError, nearest
from exoid.identification.problem import Fitted, Problem
from exoid.regression.fit import ols, wls
from exoid.regression.problem import Fit

from .huber import huber
from .joint_ml import JointML

Estimator = Callable[[Problem], Fit]
"""A function, or an object with settings such as :class:`exoid.identification.estimators.JointML`."""

ESTIMATORS: Mapping[str, Estimator] = {"huber": huber, "ml": JointML(), "ols": ols, "wls": wls}
"""Estimators that need no settings, by name."""


def find_estimator(given: str | Estimator) -> Estimator:
    """Look an estimator up by name; an estimator stays what it is."""
    if callable(given) and not isinstance(given, type):  # a class in place of its object
        return given
    if not isinstance(given, str):
        what = f"{given!r} is no estimator"
        raise BadArgumentError(what, remedy="pass a function of a problem, or an object that can be called")
    if given not in ESTIMATORS:
        remedy = f"{nearest(given, ESTIMATORS)}use one of {', '.join(ESTIMATORS)}"
        raise BadArgumentError(f"no estimator {given!r}", remedy=f"{remedy}, or pass a function", command=remedy)
    return ESTIMATORS[given]


def name_of(estimator: Estimator) -> str:
    """Name an estimator, for evidence."""
    return str(getattr(estimator, "name", getattr(estimator, "__name__", type(estimator).__name__)))


def fit_linear(problem: Problem, estimator: Estimator) -> Fitted:
    """Fit models that are linear in all parameters by one call of the estimator, and check that it returns a fit."""
    count = len(problem.r_factors)  # rows are formed here, once, and estimators solve for them
    fit = estimator(problem)
    if not isinstance(fit, Fit) or len(fit.weights) != count:
        found = f"{len(fit.weights)} weights" if isinstance(fit, Fit) else type(fit).__name__
        what = f"the estimator {name_of(estimator)} returned {found}"
        raise BadArgumentError(what, remedy=f"let it return a Fit with one weight for each of the {count} R factors")
    return Fitted(problem, fit, tuple(group.model for group in problem.groups), fit.warnings)
