"""How an estimate predicts recordings: torque, friction and residuals."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from exoid._typing import FloatArray
from exoid.estimate import Estimate, Validation, validate
from exoid.regression.every_row import make_rows
from exoid.signals import Recording
from exoid.tools.tables import DataTable
from exoid.torques.position_units import position_units
from exoid.view.colours import PREDICTED, RESIDUAL
from exoid.view.fit import plot_friction_fit, plot_prediction, plot_residual_trend
from exoid.view.style import decimation, decorate

from .blocks import MAX_LINE_POINTS, SHOWN_SECONDS, shown_part
from .page import PAGE_COLUMN, Block, Picture, Text, on_axes


class RecordingPrediction(NamedTuple):
    """A recording, its motion, and its predicted torque with a prediction band and the part that is friction."""

    recording: Recording  # recording at even time stamps
    q: FloatArray  # angles [rad], (N, n)
    v: FloatArray  # velocities [rad/s], (N, n)
    validation: Validation  # measured and predicted torque
    friction: FloatArray  # friction terms of the predicted torque [N·m], (N, n)


def predict_recording(estimate: Estimate, recording: Recording, cutoff: float | None = None) -> RecordingPrediction:
    """Predict the torque of a recording, its prediction band, and its friction."""
    # Torque, friction and band pass one filter: that of the estimate's preparation, or of the cut-off [Hz].
    if estimate.actuators is not None:
        recording = estimate.actuators.torque(recording)
    recording = estimate.model.select(recording).resampled()
    validation = validate(estimate, recording, cutoff=cutoff)
    rows = make_rows(estimate.model, recording, validation.filter.preparation)
    friction = rows.W @ np.where(estimate.model.friction, estimate.values, 0.0)
    at = np.searchsorted(rows.time, validation.time - 0.5 / recording.sample_rate)
    q, v, friction = (x[at, estimate.model.leg.base_rows :] for x in (rows.q, rows.v, friction))
    return RecordingPrediction(recording, q, v, validation, friction)


def torque_blocks(estimate: Estimate, predictions: Sequence[RecordingPrediction], held_out: bool) -> Iterator[Block]:
    """Table of prediction errors, and measured and predicted torque of the first recording."""
    rows = [(p.validation.source, *row) for p in predictions for row in p.validation.rows()]
    headers = ("recording", *predictions[0].validation.headers)
    yield DataTable("Held-out recordings" if held_out else "Recordings of the fit", headers, rows)
    yield Text(
        [
            "If the model is right, the band contains 95 % of newly measured torques. It includes the errors of the "
            "parameters, a residual as large as that of the fit, and doubt about the form of friction. Measured "
            "torque, predicted torque and band passed the same filter. A share far below 95 % in the table shows that "
            "the model is wrong for this recording, or that the leg has changed."
        ]
    )
    prediction = predictions[0]
    part = shown_part(prediction.validation.time, prediction.validation.source)
    for joint, label in enumerate(estimate.model.leg.joint_labels):
        yield Picture(
            partial(_draw_prediction, prediction=prediction, joint=joint, label=label),
            f"Measured and predicted {label} torque over time with a 95 % band and the residual",
            f"{label}, {part}, and the residual enlarged",
            "torque",
            height=PAGE_COLUMN,
        )


def _draw_prediction(figure: Figure, prediction: RecordingPrediction, joint: int, label: str) -> None:
    """Draw torque with its band above, and the residual on its own scale below."""
    validation = prediction.validation
    time = validation.time - validation.time[0]
    shown = decimation(int(np.searchsorted(time, SHOWN_SECONDS)), MAX_LINE_POINTS)
    measured, predicted = validation.measured[shown, joint], validation.predicted[shown, joint]
    half = validation.half_width[shown, joint]
    band = np.column_stack([predicted - half, predicted + half])
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(2.0, 1.0))
    unit = validation.units[joint]
    plot_prediction(above, time[shown], measured, predicted, label, band, unit.axes["torque"]).set_xlabel("")
    below.fill_between(time[shown], -half, half, color=PREDICTED, alpha=0.3, lw=0)
    below.plot(time[shown], measured - predicted, color=RESIDUAL, lw=0.6)
    decorate(below, "time [s]", f"residual [{unit.torque}]", zero=True)
    figure.align_ylabels()


def friction_blocks(estimate: Estimate, predictions: Sequence[RecordingPrediction]) -> Iterator[Block]:
    """Draw friction over velocity, of joints that have friction terms."""
    model = estimate.model
    v, residual, fitted = (
        np.concatenate(parts)
        for parts in zip(*((p.v, p.validation.residual, p.friction) for p in predictions), strict=True)
    )
    joints = [j for j, row in enumerate(model.acting[model.leg.base_rows :]) if model.friction[row].any()]
    if joints:
        yield Text(
            [
                "Measured is the torque less all modelled torque except friction. Fitted are the friction terms of the "
                "model at the same samples. Both passed the filter, which rounds the step at a reversal."
            ]
        )
    for joint in joints:
        label, unit = model.leg.joint_labels[joint], predictions[0].validation.units[joint]
        yield Picture(
            on_axes(plot_friction_fit, v[:, joint], (fitted + residual)[:, joint], fitted[:, joint], label, unit),
            f"Friction torque of {label} over its velocity, measured and fitted",
            figure="friction",
        )


def residual_pictures(estimate: Estimate, predictions: Sequence[RecordingPrediction]) -> Iterator[Picture]:
    """Draw residuals against velocity and angle; those of slides against m/s and mm."""
    q, v, residual = (
        np.concatenate(parts) for parts in zip(*((p.q, p.v, p.validation.residual) for p in predictions), strict=True)
    )
    leg = estimate.model.leg
    for against in ("velocity", "angle"):
        for joint, (label, unit) in enumerate(zip(leg.joint_labels, position_units(leg), strict=True)):
            x = v[:, joint] if against == "velocity" else q[:, joint] / unit.size
            named = f"{label} {unit.axes[against]}"
            yield Picture(
                on_axes(plot_residual_trend, x, residual[:, joint], joint, named, label, unit.torque),
                f"Residual {label} torque against {named}",
                figure=f"residuals_{against}",
            )
