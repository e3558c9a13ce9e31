"""Report of an identification: parameters, predicted torque, residuals, and advice."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from exoid.actuators.drive_data import describe_actuators
from exoid.errors import BadArgumentError, ExoidError
from exoid.estimate import Estimate
from exoid.estimate.finding import ordered, verdict_line
from exoid.estimate.text import assumptions
from exoid.signals import Recording
from exoid.signals.preparation import preparation_to_json
from exoid.tools.tables import DataTable
from exoid.view.scenes import scene

from .blocks import SHOWN_SECONDS, finding_blocks, sentence, shown_part
from .fit import RecordingPrediction, friction_blocks, predict_recording, residual_pictures, torque_blocks
from .ground import ground_blocks
from .page import Block, EmbeddedPage, Page, Text
from .parameters import IDENTIFIABILITY, advice, parameter_blocks

SHORT = "The error bars assume independent samples, and are too short."


def identification_report(
    estimate: Estimate,
    recordings: Sequence[Recording] = (),
    held_out: Sequence[Recording] = (),
    cutoff: float | None = None,
) -> Page:
    """Report an estimate: its parameters, their uncertainty, its fit, and advice on what to record next.

    Args:
        estimate: The estimate.
        recordings: Recordings that it was fitted to; none for a report of the prediction of others.
        held_out: Recordings that it was not fitted to, to test the prediction.
        cutoff: Cut-off frequency of the torques of held-out recordings [Hz]; None for the estimate's own preparation.

    Returns:
        A page: ``identification_report(...).save("report.html")``. Its ``figures()`` are those of a paper, by name.

    Raises:
        ExoidError: There is no recording, or one lacks torque or a joint of the leg.
    """
    if not (recordings or held_out):
        raise BadArgumentError("a report without recordings", remedy="pass those that the estimate was made from")
    fitted = [predict_recording(estimate, recording) for recording in recordings]
    tested = [predict_recording(estimate, recording, cutoff) for recording in held_out]
    found = ordered([*estimate.findings, *(finding for each in tested for finding in each.validation.findings)])
    contents: dict[str, Iterable[Block]] = {
        "Parameters": parameter_blocks(estimate),
        "Findings": finding_blocks(found),
        "Measured and predicted torque": torque_blocks(estimate, tested or fitted, bool(tested)),
        "Ground force": ground_blocks(estimate, [each.recording for each in tested or fitted]),
        "Friction": friction_blocks(estimate, fitted or tested),
        "Residuals": [Text([SHORT]), *residual_pictures(estimate, fitted or tested)],
        "Replay": _replay(estimate, (tested or fitted)[0].recording),
        "What to record next": advice(estimate, [each.recording for each in fitted]) if fitted else (),
        "Inputs and settings": _inputs_and_settings(estimate),
    }
    count = len(estimate.inputs)
    title = f"identified from {count} recording{'' if count == 1 else 's'}"
    if not fitted:
        title = f"prediction of {', '.join(each.validation.source for each in tested)}"
    return Page.of(f"{estimate.model.leg.description.name}: {title}", summary(estimate, tested), contents)


def summary(estimate: Estimate, tested: Sequence[RecordingPrediction]) -> list[str]:
    """Summarise the identifiability of parameters, the prediction of held-out recordings, and warnings."""
    grades = estimate.identifiability
    bad = [finding for finding in estimate.findings if finding.severity != "info"]
    counts = ", ".join(f"{grades.count(grade)} {text}" for grade, text in IDENTIFIABILITY.items() if grade in grades)
    lines = [f"{len(grades)} parameters: {counts}."]
    for prediction in tested:
        joints = ", ".join(
            f"{joint} {error:.3f}" if np.isfinite(error) else f"{joint} not measured"
            for joint, error in zip(estimate.joint_names, prediction.validation.nrmse, strict=True)
        )
        lines.append(
            f"Held-out recording {prediction.validation.source}, {verdict_line(prediction.validation.findings)}. "
            f"NRMSE, the RMS error over the standard deviation of the torque: {joints}."
        )
    if not tested:
        lines.append("There is no held-out recording: the errors below are those of the fit.")
    lines += [f"{finding.kind}{f' at {finding.joint}' if finding.joint else ''}: {finding.message}." for finding in bad]
    return lines + [f"Warning: {warning}." for warning in estimate.warnings]


def _replay(estimate: Estimate, recording: Recording) -> Iterator[Block]:
    """Replay the beginning of a recording in three dimensions."""
    shown = recording.between(recording.time[0], recording.time[0] + SHOWN_SECONDS)
    part = shown_part(recording.time, recording.file_name or "array")
    try:
        replay = scene(estimate, recording=shown)
        page = EmbeddedPage(replay.html(), f"{replay.title} in three dimensions")
    except ExoidError as error:
        yield Text([f"The leg cannot be drawn: {error.what}."])
        return
    yield from (Text([f"Shown: {part}. Drag to turn the view, scroll to zoom."]), page)


def _inputs_and_settings(estimate: Estimate) -> Iterator[Block]:
    """Recordings, drives, settings of the identification, and the prior knowledge that entered it."""
    rows = [
        (i.label, f"{i.samples}", f"{i.sample_rate:.4g}", "moves" if i.moving_base else "at rest", i.sha256)
        for i in estimate.inputs
    ]
    yield DataTable("Recordings", ("name", "samples", "rate [Hz]", "base", "sha256"), rows)
    if estimate.actuators is not None:
        yield Text(["Torques were computed of what these drives measured.", *describe_actuators(estimate.actuators)])
    terms = ", ".join(dict.fromkeys(type(term).__name__ for term in estimate.model.terms)) or "none"
    settings = preparation_to_json(estimate.preparation)
    name = settings.pop("name")
    numbers = {key: x for key, x in settings.items() if x is not None}
    values = (f"{key.replace('_', ' ')} {x:.4g}" + " Hz" * key.endswith("cutoff") for key, x in numbers.items())
    yield Text(
        [
            f"Estimator: {estimate.estimator}; {estimate.dof:.0f} degrees of freedom.",
            f"Torque terms besides the rigid bodies: {terms}.",
            f"Preparation: {', '.join([name, *values])}.",
            *map(sentence, assumptions(estimate.prior_knowledge, estimate.bounded)),
            *(f"{regrouped}." for regrouped in estimate.regrouped),
        ]
    )
