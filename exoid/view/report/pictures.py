"""Pictures in the report of an identification."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from exoid._typing import FloatArray
from exoid.estimate import Estimate
from exoid.view.coverage import plot_coverage, plot_excitation
from exoid.view.friction import plot_friction_fit
from exoid.view.parameters import plot_correlation, plot_parameters
from exoid.view.residuals import plot_prediction, plot_residual_band, plot_residual_trend
from exoid.view.style import decimation

from .page import Picture, draw_picture
from .recording_prediction import RecordingPrediction

SHOWN_SECONDS = 20.0
"""Length of the part of a recording that is drawn over time and replayed [s]."""

MAX_LINE_POINTS = 1000
"""Largest number of samples of a line: 50 per second."""


def shown_part(time: FloatArray, source: str) -> str:
    """Name the part of a recording that is drawn."""
    duration = float(time[-1] - time[0])
    whole = duration <= SHOWN_SECONDS
    return f"{source} ({duration:.0f} s)" if whole else f"the first {SHOWN_SECONDS:.0f} s of {source}"


def parameter_pictures(estimate: Estimate, other_values: Mapping[str, Mapping[str, float]]) -> Iterator[Picture]:
    """Draw the parameters of each unit with their intervals, and the correlation matrix."""
    for unit in dict.fromkeys(estimate.units):
        names = [name for name, its_unit in zip(estimate.names, estimate.units, strict=True) if its_unit == unit]
        yield _plot(
            plot_parameters,
            (estimate, names, other_values),
            f"Parameters in {unit} with 95 % intervals: {', '.join(names)}",
            f"Parameters in {unit} with 95 % intervals",
            aspect=max(0.5, 0.2 + 0.08 * len(names)),
        )
    yield draw_picture(
        lambda figure: plot_correlation(figure.add_subplot(), estimate),
        f"Correlation matrix of the errors of {len(estimate.names)} parameters",
        "Correlation of the errors; strong colours mark pairs that are hard to separate",
        columns=2.0,
        aspect=1.75,
        full=True,
    )


def prediction_pictures(estimate: Estimate, prediction: RecordingPrediction) -> Iterator[Picture]:
    """Draw the torque of each joint at the beginning of a recording, and the residual on its own scale."""
    part = shown_part(prediction.validation.time, prediction.validation.source)
    for joint, label in enumerate(estimate.model.leg.joint_labels):
        yield draw_picture(
            partial(_draw_prediction, prediction=prediction, joint=joint, label=label),
            f"Measured and predicted {label} torque over time with a 95 % band and the residual",
            f"{label}, {part}, and the residual enlarged",
            aspect=1.0,
        )


def friction_pictures(estimate: Estimate, predictions: Sequence[RecordingPrediction]) -> Iterator[Picture]:
    """Draw friction over velocity, of joints that have friction terms."""
    model = estimate.model
    v, measured, fitted = (
        np.concatenate(parts)
        for parts in zip(*((p.v, p.measured_friction, p.friction) for p in predictions), strict=True)
    )
    for joint, label in enumerate(model.leg.joint_labels):
        if model.friction[model.acting[joint]].any():
            yield _plot(
                plot_friction_fit,
                (v[:, joint], measured[:, joint], fitted[:, joint], joint, label),
                f"Friction torque of {label} over its velocity, measured and fitted",
            )


def residual_pictures(estimate: Estimate, predictions: Sequence[RecordingPrediction]) -> Iterator[Picture]:
    """Draw residuals against velocity and angle."""
    q, v, residual = (
        np.concatenate(parts) for parts in zip(*((p.q, p.v, p.validation.residual) for p in predictions), strict=True)
    )
    trends = {(trend.joint, trend.against): trend for trend in estimate.trends}
    for joint, (name, label) in enumerate(zip(estimate.joint_names, estimate.model.leg.joint_labels, strict=True)):
        velocity = (v, trends.get((name, "velocity")), "velocity [rad/s]")
        angle = (np.rad2deg(q), trends.get((name, "angle")), "angle [deg]")
        for x, trend, quantity in (velocity, angle):
            yield _plot(
                plot_residual_trend,
                (x[:, joint], residual[:, joint], joint, f"{label} {quantity}", label, trend),
                f"Residual {label} torque against {label} {quantity}",
            )


def excitation_pictures(estimate: Estimate, predictions: Sequence[RecordingPrediction]) -> Iterator[Picture]:
    """Draw the angles and velocities that the recordings cover."""
    q, v = (np.concatenate(parts) for parts in zip(*((p.q, p.v) for p in predictions), strict=True))
    labels, limits = estimate.model.leg.joint_labels, estimate.model.leg.limits
    for joint, label in enumerate(labels):
        yield _plot(
            plot_excitation,
            (q[:, joint], v[:, joint], joint, label),
            f"{label} velocity over {label} angle of all recordings",
        )
    for joint in range(len(labels) - 1):
        both = slice(joint, joint + 2)
        yield _plot(
            plot_coverage,
            (q[:, both], labels[both], (limits.lower[both], limits.upper[both])),
            f"Angles of {labels[joint]} and {labels[joint + 1]} against each other",
        )


def _plot(
    plot: Callable[..., object], arguments: Sequence[object], alt_text: str, caption: str = "", *, aspect: float = 0.7
) -> Picture:
    """Draw a picture of single axes by ``plot(ax, *arguments)``."""
    return draw_picture(lambda figure: plot(figure.add_subplot(), *arguments), alt_text, caption, aspect=aspect)


def _draw_prediction(figure: Figure, prediction: RecordingPrediction, joint: int, label: str) -> None:
    """Draw torque with its band above, and the residual on its own scale below."""
    validation = prediction.validation
    time = validation.time - validation.time[0]
    shown = decimation(int(np.searchsorted(time, SHOWN_SECONDS)), MAX_LINE_POINTS)
    measured, predicted = validation.measured[shown, joint], validation.predicted[shown, joint]
    half = prediction.band_half_width[shown, joint]
    band = np.column_stack([predicted - half, predicted + half])
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(2.0, 1.0))
    plot_prediction(above, time[shown], measured, predicted, label, band).set_xlabel("")
    plot_residual_band(below, time[shown], measured - predicted, half)
    figure.align_ylabels()
