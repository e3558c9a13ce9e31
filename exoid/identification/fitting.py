"""What is fitted to what, where it begins, and what comes out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.estimate.nonlinear import NonlinearParameters
from exoid.leg import Leg
from exoid.regression.fit import Fit
from exoid.regression.layout import ParameterLayout
from exoid.regression.prior_knowledge import NO_PRIOR_KNOWLEDGE, PriorKnowledge
from exoid.torques import Term, TorqueModel, nonlinear_settings, with_settings

from .estimators import Estimator
from .group_rows import GroupRows
from .groups import Group
from .problem import Problem

Keep = Callable[[int, FloatArray], NDArray[np.bool_]]
"""Which rows to use: recording index, times [s] → mask."""


class Task(NamedTuple):
    """What is fitted to what.

    Attributes:
        groups: Groups of recordings; one is the usual case.
        terms: Terms, settings of which may be nonlinear parameters.
        estimator: The estimator.
        own: Names of parameters that each group has of its own.
        prior_knowledge: What is known beside the recordings.
        keep: Which rows to use; None for all.
    """

    groups: tuple[Group, ...]
    terms: tuple[Term, ...]
    estimator: Estimator
    own: tuple[str, ...] = ()
    prior_knowledge: PriorKnowledge = NO_PRIOR_KNOWLEDGE
    keep: Keep | None = None

    @property
    def linear(self) -> bool:
        """Whether torque is linear in all parameters."""
        leg = self.groups[0].leg
        settings = nonlinear_settings(self.terms, leg.joint_names, leg.joint_labels)
        return not settings and not any(term.loaded for term in self.terms)

    def problem(self, models: Sequence[TorqueModel]) -> Problem:
        """Form the regression problem of torque models, one for each group."""
        share = 1.0 / len(self.groups)
        rows = tuple(
            GroupRows(model, group.data, group.preparation, self.keep, share)
            for model, group in zip(models, self.groups, strict=True)
            if group.preparation is not None
        )
        layout = ParameterLayout.of([g.name for g in self.groups], models[0].names, models[0].units, self.own)
        return Problem(rows, layout, layout.spread(self.prior_knowledge))


class Fitted(NamedTuple):
    """A fit.

    Attributes:
        models: Torque model of each group with all settings, loaded by the fitted rigid bodies.
        values: β, (P,).
        nonlinear: Nonlinear parameters that were found, without covariance.
        problem: Rows, about the solution linear in β and in the nonlinear parameters that are not held.
        fit: Solution in both.
        warnings: What the reader should know.
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


def starting_model(leg: Leg, terms: Sequence[Term]) -> TorqueModel:
    """Make a model with all nonlinear parameters at their start values."""
    names, labels = leg.joint_names, leg.joint_labels
    start = {setting.name: setting.free.start for setting in nonlinear_settings(terms, names, labels)}
    return TorqueModel(leg, with_settings(terms, names, labels, start))
