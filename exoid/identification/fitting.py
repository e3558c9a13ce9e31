"""Task, start and result of a fit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from exoid._typing import FloatArray
from exoid.actuators import Actuators
from exoid.estimate.nonlinear import NonlinearParameters
from exoid.regression.fit import Fit
from exoid.regression.parameters import NO_PRIOR_KNOWLEDGE, PriorKnowledge
from exoid.torques import Term, TorqueModel

from .estimators import Estimator
from .group_rows import Group, Keep
from .problem import Problem


class Task(NamedTuple):
    """Torque model, data and estimator of a fit.

    Attributes:
        groups: Groups of recordings; one is the usual case.
        models: Torque model of each group, nonlinear parameters at their start values.
        terms: Terms of the models, settings of which may be nonlinear parameters.
        estimator: The estimator.
        own: Names of parameters that each group has of its own.
        prior_knowledge: Known parameters, priors and signs.
        keep: Function that selects rows; None for all.
        unknown: Drives with unknown constants, which are found beside the parameters; None for none.
    """

    groups: tuple[Group, ...]
    models: tuple[TorqueModel, ...]
    terms: tuple[Term, ...]
    estimator: Estimator
    own: tuple[str, ...] = ()
    prior_knowledge: PriorKnowledge = NO_PRIOR_KNOWLEDGE
    keep: Keep | None = None
    unknown: Actuators | None = None


class Fitted(NamedTuple):
    """A fit.

    Attributes:
        models: Torque model of each group with all settings, loaded by the fitted rigid bodies.
        values: β, (P,).
        nonlinear: Nonlinear parameters that were found, without covariance.
        problem: Rows, about the solution linear in β and in the nonlinear parameters that are not held.
        fit: Solution in both.
        warnings: Warnings for the reader.
    """

    models: tuple[TorqueModel, ...]
    values: FloatArray
    nonlinear: NonlinearParameters
    problem: Problem
    fit: Fit
    warnings: tuple[str, ...]


class Start(NamedTuple):
    """Where a fit begins.

    Attributes:
        values: β, (P,).
        settings: θ by name.
        weights: Weights of the R factors.
    """

    values: FloatArray
    settings: dict[str, float]
    weights: Sequence[float]

    @staticmethod
    def at(fitted: Fitted) -> Start:
        """Begin where a fit has ended."""
        nonlinear = fitted.nonlinear
        settings = dict(zip(nonlinear.names, nonlinear.values.tolist(), strict=True))
        return Start(fitted.values, settings, fitted.fit.weights)
