"""What is fitted to what, where it begins, and what comes out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.estimate.nonlinear import Shapes
from exoid.leg import Leg
from exoid.regression.prior_knowledge import NOTHING, Assumed
from exoid.signals import Cluster, Poses, Preparation, Recording
from exoid.torques import Term, TorqueModel, free_shapes, with_shapes

from .estimators import Estimator, Fit
from .problem import Problem

Keep = Callable[[int, FloatArray], NDArray[np.bool_]]
"""Which rows to use: recording index, times [s] → mask."""


class Task(NamedTuple):
    """What is fitted to what.

    Attributes:
        leg: The leg.
        terms: Terms, settings of which may be free.
        data: Recordings and poses.
        preparation: How they become rows.
        estimator: The estimator, or its name.
        keep: Which rows to use; None for all.
        assumed: What is known beside them.
    """

    leg: Leg
    terms: tuple[Term, ...]
    data: Sequence[Recording | Poses] | Cluster
    preparation: Preparation
    estimator: Estimator | str
    keep: Keep | None = None
    assumed: Assumed = NOTHING

    def problem(self, model: TorqueModel) -> Problem:
        """Rows of a model."""
        return Problem(model, self.data, self.preparation, self.keep, self.assumed)


class Fitted(NamedTuple):
    """A fit.

    Attributes:
        model: With all settings, loaded by the fitted rigid bodies.
        values: β, (P,).
        shapes: Settings that were found, without covariance.
        problem: Rows, about the solution linear in β and in the settings that are not held.
        fit: Solution in both.
        remarks: What the reader should know.
    """

    model: TorqueModel
    values: FloatArray
    shapes: Shapes
    problem: Problem
    fit: Fit
    remarks: tuple[str, ...]


class Start(NamedTuple):
    """Where a fit begins.

    Attributes:
        values: β, (P,).
        settings: θ by name.
        weights: Of the triangles.
    """

    values: FloatArray
    settings: dict[str, float]
    weights: Sequence[float]

    @staticmethod
    def at(fitted: Fitted) -> Start:
        """Begin where a fit has ended."""
        shapes = fitted.shapes
        settings = dict(zip(shapes.names, shapes.values.tolist(), strict=True))
        return Start(fitted.values, settings, fitted.fit.weights)


def starting_model(leg: Leg, terms: Sequence[Term]) -> TorqueModel:
    """Make a model with all settings that are to be found where they start."""
    names, labels = leg.joint_names, leg.joint_labels
    start = {shape.name: shape.free.start for shape in free_shapes(terms, names, labels)}
    return TorqueModel(leg, with_shapes(terms, names, labels, start))
