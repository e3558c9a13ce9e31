"""Estimators by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from exoid.errors import ExoidError
from exoid.identification.problem import Problem
from exoid.regression.fit import Fit

from .gls import gls
from .huber import huber
from .instrumental import InstrumentalVariables
from .joint_ml import JointML
from .least_squares import ols, wls
from .output_error import OutputError

Estimator = Callable[[Problem], Fit]
"""A function, or an object with settings such as :class:`exoid.identification.estimators.JointML`."""

ESTIMATORS: Mapping[str, Estimator] = {"gls": gls, "huber": huber, "ml": JointML(), "ols": ols, "wls": wls}
"""Estimators that need no settings."""

NEED_LOOP: Mapping[str, Estimator] = {"iv": InstrumentalVariables(), "output-error": OutputError()}
"""Estimators that need a :class:`ClosedLoop`, and say so when they are used without."""


def find_estimator(given: str | Estimator) -> Estimator:
    """Look an estimator up by name; an estimator stays what it is.

    Args:
        given: Name of an estimator, or an estimator.

    Returns:
        The estimator.

    Raises:
        ExoidError: There is none of that name.
    """
    if callable(given):
        return given
    known = {**ESTIMATORS, **NEED_LOOP}
    if given not in known:
        raise ExoidError(f"no estimator {given!r}", remedy=f"use one of {', '.join(ESTIMATORS)}")
    return known[given]


def name_of(estimator: Estimator) -> str:
    """Name of an estimator, for evidence."""
    return str(getattr(estimator, "name", None) or getattr(estimator, "__name__", type(estimator).__name__))
