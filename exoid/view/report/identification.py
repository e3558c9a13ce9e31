"""Report of an identification: parameters, predicted torque, residuals, excitation, and advice."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from exoid.errors import ExoidError
from exoid.estimate import Estimate, predict_motion
from exoid.signals import Recording
from exoid.view.scenes import scene

from . import text
from .advice import advice
from .ground_pictures import ground_blocks
from .page import Block, EmbeddedPage, Page, Section, Text
from .pictures import (
    SHOWN_SECONDS,
    excitation_pictures,
    friction_pictures,
    parameter_pictures,
    prediction_pictures,
    residual_pictures,
    shown_part,
)
from .recording_prediction import RecordingPrediction, predict_recording


def identification_report(
    estimate: Estimate,
    recordings: Sequence[Recording],
    held_out: Sequence[Recording] = (),
    other_values: Mapping[str, Mapping[str, float]] | None = None,
) -> Page:
    """Report an estimate: its parameters, their uncertainty, its fit, and advice on what to record next.

    Args:
        estimate: The estimate.
        recordings: Recordings that it was fitted to.
        held_out: Recordings that it was not fitted to, to test the prediction.
        other_values: Values by parameter name, by label, for comparison; None for those of the leg's URDF.

    Returns:
        A page: ``identification_report(...).save("report.html")``.

    Raises:
        ExoidError: There is no recording, or one lacks torque or a joint of the leg.
    """
    if not recordings:
        raise ExoidError("a report without recordings", remedy="pass those that the estimate was made from")
    if other_values is None:
        leg = estimate.model.leg
        other_values = {"URDF": dict(zip(leg.parameter_names, leg.parameters.tolist(), strict=True))}
    fitted = [predict_recording(estimate, recording) for recording in recordings]
    tested = [predict_recording(estimate, recording) for recording in held_out]
    contents: dict[str, Iterator[Block]] = {
        "Parameters": _parameters(estimate, other_values),
        "Findings": text.finding_blocks(estimate),
        "Measured and predicted torque": _torque(estimate, tested or fitted, bool(tested)),
        "Ground force": ground_blocks(estimate, [each.recording for each in tested or fitted]),
        "Friction": _friction(estimate, fitted),
        "Residuals": _residuals(estimate, fitted),
        "Replay": _replay(estimate, (tested or fitted)[0].recording),
        "Excitation": excitation_pictures(estimate, fitted),
        "What to record next": advice(estimate, [each.recording for each in fitted]),
        "Inputs and settings": _inputs_and_settings(estimate),
    }
    sections = [Section(title, blocks) for title, content in contents.items() if (blocks := list(content))]
    title = f"{estimate.model.leg.description.name}: identified from {_count(len(estimate.inputs), 'recording')}"
    return Page(title, text.summary(estimate, tested), sections)


def _parameters(estimate: Estimate, other_values: Mapping[str, Mapping[str, float]]) -> Iterator[Block]:
    yield text.parameter_table(estimate, other_values)
    yield from parameter_pictures(estimate, other_values)


def _torque(estimate: Estimate, predictions: Sequence[RecordingPrediction], held_out: bool) -> Iterator[Block]:
    yield text.error_table(estimate, predictions, held_out)
    yield Text([text.BAND_NOTE])
    yield from prediction_pictures(estimate, predictions[0])


def _friction(estimate: Estimate, predictions: Sequence[RecordingPrediction]) -> Iterator[Block]:
    if pictures := list(friction_pictures(estimate, predictions)):
        yield Text([text.FRICTION_NOTE])
        yield from pictures


def _residuals(estimate: Estimate, predictions: Sequence[RecordingPrediction]) -> Iterator[Block]:
    if estimate.trends:
        yield text.trend_table(estimate)
    yield text.trend_notes(estimate)
    yield from residual_pictures(estimate, predictions)


def _replay(estimate: Estimate, recording: Recording) -> Iterator[Block]:
    """Replay the beginning of a recording, with the motion that the estimate predicts unless that diverges."""
    shown = recording.between(recording.time[0], recording.time[0] + SHOWN_SECONDS)
    try:
        ghost, note = predict_motion(estimate, shown), "the translucent leg moves as the estimate predicts"
    except ExoidError as error:
        ghost, note = None, f"no prediction of the motion: {error.what}"
    try:
        replay = scene(estimate, recording=shown, ghost=ghost, ghost_label="predicted")
    except ExoidError as error:
        yield Text([f"The leg cannot be drawn: {error.what}."])
        return
    source = recording.source.name if recording.source else "array"
    part = shown_part(recording.time, source)
    yield Text([f"Shown: {part}; {note}. Drag to turn the view, scroll to zoom."])
    yield EmbeddedPage(replay.html(), f"{replay.title} in three dimensions")


def _inputs_and_settings(estimate: Estimate) -> Iterator[Block]:
    yield text.input_table(estimate)
    yield from text.drive_blocks(estimate)
    yield from text.influence_blocks(estimate)
    yield text.settings(estimate)


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" + ("" if number == 1 else "s")
