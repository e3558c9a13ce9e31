"""Estimators by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, overload

from exoid.errors import BadArgumentError
from exoid.estimate.nonlinear import NO_NONLINEAR_PARAMETERS
from exoid.identification.problem import Fitted, Problem
from exoid.regression.fit import Fit, ols, wls
from exoid.tools.registry import Registry

from .huber import huber
from .joint_ml import JointML

Estimator = Callable[[Problem], Fit]
"""A function, or an object with settings such as :class:`exoid.identification.estimators.JointML`."""

AnyEstimator = TypeVar("AnyEstimator", bound=Estimator)


def _check(estimator: Estimator) -> None:
    """Refuse what cannot be called, and a class in place of its object."""
    if not callable(estimator) or isinstance(estimator, type):
        raise BadArgumentError(
            f"{estimator!r} is no estimator", remedy="pass a function of a problem, or an object that can be called"
        )


ESTIMATORS: Registry[Estimator] = Registry("estimator", "exoid.identification.register_estimator", _check)
"""Estimators that need no settings, by name: exoid's, and those that were registered."""


@overload
def register_estimator(name: str) -> Callable[[AnyEstimator], AnyEstimator]: ...


@overload
def register_estimator(name: str, estimator: AnyEstimator) -> AnyEstimator: ...


def register_estimator(
    name: str, estimator: AnyEstimator | None = None
) -> AnyEstimator | Callable[[AnyEstimator], AnyEstimator]:
    """Give an estimator a name, for ``identify(..., estimator="name")`` and the command line.

    Loading an estimate needs no estimator.

    Args:
        name: Letters, digits, ".", "_" and "-", such as "ridge".
        estimator: A function, or an object with ``__call__``, of a problem. It returns a
            :class:`exoid.identification.estimators.Fit`. With no more than the members of
            :class:`exoid.regression.problem.RowProblem` it works for groups of recordings too. None for a decorator.

    Returns:
        The estimator as it is, or the decorator.

    Raises:
        ExoidError: The name is taken or has another form, or the estimator cannot be called.

    Example:
        >>> @register_estimator("plain")
        ... def plain(problem):
        ...     return Fit(problem.solve(stack(problem.r_factors)), [1.0] * len(problem.r_factors))
    """
    if estimator is None:
        return lambda estimator: register_estimator(name, estimator)
    ESTIMATORS.register(name, estimator)
    return estimator


ESTIMATORS.register("huber", huber)
ESTIMATORS.register("ml", JointML())
ESTIMATORS.register("ols", ols)
ESTIMATORS.register("wls", wls)


def find_estimator(given: str | Estimator) -> Estimator:
    """Look an estimator up by name; an estimator stays what it is."""
    return given if callable(given) else ESTIMATORS.find(given)


def name_of(estimator: Estimator) -> str:
    """Name an estimator, for evidence."""
    own = getattr(estimator, "name", None) or ESTIMATORS.name_of(estimator)
    return str(own or getattr(estimator, "__name__", type(estimator).__name__))


def fit_linear(problem: Problem, estimator: Estimator) -> Fitted:
    """Fit models that are linear in all parameters, by one call of the estimator."""
    problem.refuse_empty_joints()
    fit = fit_by(estimator, problem)
    return Fitted(problem, fit, tuple(group.model for group in problem.groups), NO_NONLINEAR_PARAMETERS, fit.warnings)


def fit_by(estimator: Estimator, problem: Problem) -> Fit:
    """Let an estimator solve a problem, and check that it returns a fit."""
    fit = estimator(problem)
    if not isinstance(fit, Fit) or len(fit.weights) != len(problem.r_factors):
        found = f"{len(fit.weights)} weights" if isinstance(fit, Fit) else type(fit).__name__
        raise BadArgumentError(
            f"the estimator {name_of(estimator)} returned {found}",
            remedy=f"let it return a Fit with one weight for each of the {len(problem.r_factors)} R factors",
        )
    return fit
