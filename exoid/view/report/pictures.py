"""Pictures in the report of an identification."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from exoid._typing import FloatArray
from exoid.estimate import Estimate
from exoid.regression import Trend
from exoid.view.coverage import plot_coverage, plot_excitation
from exoid.view.friction import plot_friction_fit
from exoid.view.parameters import plot_correlation, plot_parameters
from exoid.view.residuals import plot_prediction, plot_residual_along, plot_residual_band

from .evidence import Evidence
from .page import Picture, picture

SHOWN = 20.0
"""Of a recording [s], as torque over time and in motion."""

DRAWN = 1000
"""Samples of a line, at most: 50 a second."""


def parameter_pictures(estimate: Estimate, beside: Mapping[str, Mapping[str, float]]) -> Iterator[Picture]:
    """Draw intervals, unit by unit, and correlations."""
    for unit in dict.fromkeys(estimate.units):
        names = [name for name, own in zip(estimate.names, estimate.units, strict=True) if own == unit]
        yield picture(
            lambda figure, names=names: plot_parameters(figure.add_subplot(), estimate, names, beside),  # type: ignore[misc]
            f"Parameters in {unit} with 95 % intervals: {', '.join(names)}",
            f"Parameters in {unit} with 95 % intervals",
            aspect=max(0.5, 0.2 + 0.08 * len(names)),
        )
    yield picture(
        lambda figure: plot_correlation(figure.add_subplot(), estimate),
        f"Correlation matrix of the errors of {len(estimate.names)} parameters",
        "Correlation of the errors: strong colours trade against each other",
        aspect=0.9,
    )


def prediction_pictures(estimate: Estimate, evidence: Evidence) -> Iterator[Picture]:
    """Draw the torque of each joint at the beginning of a recording."""
    for joint, label in enumerate(estimate.model.leg.joint_labels):
        yield picture(
            partial(_draw_prediction, evidence=evidence, joint=joint, label=label),
            f"Measured and predicted {label} torque over time with a 95 % band and the residual",
            f"{label}, the first {SHOWN:.0f} s of {evidence.validation.source}, and the residual enlarged",
            aspect=0.9,
        )


def friction_pictures(estimate: Estimate, evidence: Sequence[Evidence]) -> Iterator[Picture]:
    """Draw friction over velocity, of joints that have friction terms."""
    model = estimate.model
    for joint, label in enumerate(model.leg.joint_labels):
        if not model.friction[model.acting[joint]].any():
            continue
        v, measured, fitted = (
            np.concatenate([x[:, joint] for x in each])
            for each in zip(*((e.v, e.measured_friction, e.friction) for e in evidence), strict=True)
        )
        yield picture(
            partial(_draw_friction, v=v, measured=measured, fitted=fitted, joint=joint, label=label),
            f"Friction torque of {label} over its velocity, measured and fitted",
        )


def residual_pictures(estimate: Estimate, evidence: Sequence[Evidence]) -> Iterator[Picture]:
    """Draw what is left over, against velocity and angle."""
    q, v = (np.concatenate([getattr(e, name) for e in evidence]) for name in ("q", "v"))
    residual = np.concatenate([e.validation.residual for e in evidence])
    trends = {(trend.joint, trend.against): trend for trend in estimate.trends}
    for joint, (name, label) in enumerate(zip(estimate.joint_names, estimate.model.leg.joint_labels, strict=True)):
        axes = ((v, "velocity", "velocity [rad/s]"), (np.rad2deg(q), "angle", "angle [deg]"))
        for x, against, words in axes:
            draw = partial(
                _draw_residual,
                x=x[:, joint],
                residual=residual[:, joint],
                joint=joint,
                xlabel=f"{label} {words}",
                label=label,
                trend=trends.get((name, against)),  # type: ignore[arg-type]
            )
            yield picture(draw, f"Residual {label} torque against {label} {words}")


def excitation_pictures(estimate: Estimate, evidence: Sequence[Evidence]) -> Iterator[Picture]:
    """Draw where the joints have been, and how fast."""
    q, v = (np.concatenate([getattr(e, name) for e in evidence]) for name in ("q", "v"))
    labels, limits = estimate.model.leg.joint_labels, estimate.model.leg.limits
    for joint, label in enumerate(labels):
        yield picture(
            partial(_draw_excitation, q=q[:, joint], v=v[:, joint], joint=joint, label=label),
            f"{label} velocity over {label} angle of all recordings",
        )
    for joint in range(len(labels) - 1):
        pair, span = (labels[joint], labels[joint + 1]), slice(joint, joint + 2)
        yield picture(
            partial(_draw_coverage, q=q[:, span], labels=pair, limits=(limits.lower[span], limits.upper[span])),
            f"Angles of {pair[0]} and {pair[1]} against each other",
        )


def _draw_prediction(figure: Figure, evidence: Evidence, joint: int, label: str) -> None:
    validation = evidence.validation
    time = validation.time - validation.time[0]
    count = int(np.searchsorted(time, SHOWN))
    shown = slice(0, count, max(1, -(-count // DRAWN)))
    measured, predicted = validation.measured[shown, joint], validation.predicted[shown, joint]
    half = evidence.half_width[shown, joint]
    band = np.column_stack([predicted - half, predicted + half])
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(2.4, 1.0))
    plot_prediction(above, time[shown], measured, predicted, label, band).set_xlabel("")
    plot_residual_band(below, time[shown], measured - predicted, half)


def _draw_friction(
    figure: Figure, v: FloatArray, measured: FloatArray, fitted: FloatArray, joint: int, label: str
) -> None:
    plot_friction_fit(figure.add_subplot(), v, measured, fitted, joint, label)


def _draw_residual(
    figure: Figure, x: FloatArray, residual: FloatArray, joint: int, xlabel: str, label: str, trend: Trend | None
) -> None:
    plot_residual_along(figure.add_subplot(), x, residual, joint, xlabel, label, trend)


def _draw_excitation(figure: Figure, q: FloatArray, v: FloatArray, joint: int, label: str) -> None:
    plot_excitation(figure.add_subplot(), q, v, joint, label)


def _draw_coverage(
    figure: Figure, q: FloatArray, labels: tuple[str, str], limits: tuple[FloatArray, FloatArray]
) -> None:
    plot_coverage(figure.add_subplot(), q, labels, limits)
