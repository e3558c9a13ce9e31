"""The report of an identification: what was found, how far to trust it, and what to record next."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from exoid.errors import ExoidError
from exoid.estimate import Estimate, predict_motion
from exoid.signals import Recording
from exoid.view.scenes import scene

from . import text as words
from .evidence import Evidence, gather
from .page import Embedded, Page, Part, Section, Words
from .pictures import (
    SHOWN,
    excitation_pictures,
    friction_pictures,
    parameter_pictures,
    prediction_pictures,
    residual_pictures,
)


def identification_report(
    estimate: Estimate,
    recordings: Sequence[Recording],
    held_out: Sequence[Recording] = (),
    beside: Mapping[str, Mapping[str, float]] | None = None,
) -> Page:
    """Tell what was identified from what, how well, and what is missing.

    Args:
        estimate: The estimate.
        recordings: What it was fitted to.
        held_out: Recordings that it was not fitted to, to test the prediction.
        beside: Other values by parameter name, such as those of CAD; None for the leg's own before identification.

    Returns:
        A page: ``identification_report(...).write("report.html")``.

    Raises:
        ExoidError: There is no recording, or one lacks torque or a joint of the leg.
    """
    if not recordings:
        raise ExoidError("a report without recordings", remedy="pass those that the estimate was made from")
    if beside is None:
        leg = estimate.model.leg
        beside = {"URDF": dict(zip(leg.parameter_names, leg.parameters.tolist(), strict=True))}
    fitted = [gather(estimate, recording) for recording in recordings]
    tested = [gather(estimate, recording) for recording in held_out]
    sections = [
        Section("Parameters", [words.parameter_table(estimate, beside), *parameter_pictures(estimate, beside)]),
        Section("Measured and predicted torque", list(_torque(estimate, tested or fitted, bool(tested)))),
        Section("Friction", list(_friction(estimate, fitted))),
        Section("What the model leaves over", list(_left_over(estimate, fitted))),
        Section("The leg in motion", list(_scene(estimate, (tested or fitted)[0].recording))),
        Section("What the motion excites", list(excitation_pictures(estimate, fitted))),
        Section(
            "What to record next",
            [Words(lines) for lines in words.advice(estimate, [each.recording for each in fitted])],
        ),
        Section("From what, and how", list(_origin(estimate))),
    ]
    title = f"{estimate.model.leg.description.name}: identified from {_count(len(estimate.inputs), 'recording')}"
    return Page(title, words.summary(estimate, tested), [section for section in sections if section.parts])


def _torque(estimate: Estimate, evidence: Sequence[Evidence], held_out: bool) -> Iterator[Part]:
    yield words.error_table(estimate, evidence, held_out)
    yield Words([words.BAND])
    yield from prediction_pictures(estimate, evidence[0])


def _friction(estimate: Estimate, evidence: Sequence[Evidence]) -> Iterator[Part]:
    if pictures := list(friction_pictures(estimate, evidence)):
        yield Words([words.FRICTION])
        yield from pictures


def _left_over(estimate: Estimate, evidence: Sequence[Evidence]) -> Iterator[Part]:
    if estimate.trends:
        yield words.trend_table(estimate)
    yield Words(words.dependence(estimate))
    yield from residual_pictures(estimate, evidence)


def _scene(estimate: Estimate, recording: Recording) -> Iterator[Part]:
    """Replay the beginning of a recording, beside what the estimate makes of its torques unless that diverges."""
    shown = recording.between(recording.time[0], recording.time[0] + SHOWN)
    try:
        ghost, said = predict_motion(estimate, shown), "the translucent leg moves as the estimate predicts"
    except ExoidError as error:
        ghost, said = None, f"no prediction of the motion: {error.what}"
    try:
        drawn = scene(estimate, recording=shown, ghost=ghost, ghost_label="predicted")
    except ExoidError as error:
        yield Words([f"The leg cannot be drawn: {error.what}."])
        return
    source = recording.source.name if recording.source else "array"
    yield Words([f"The first {SHOWN:.0f} s of {source}; {said}. Drag to turn it, scroll to come nearer."])
    yield Embedded(drawn.html(), f"{drawn.title} in three dimensions")


def _origin(estimate: Estimate) -> Iterator[Part]:
    yield words.inputs(estimate)
    for part in words.influence_parts(estimate):
        yield Words(part) if isinstance(part, list) else part
    yield Words(words.settings(estimate))


def _count(number: int, what: str) -> str:
    return f"{number} {what}" + ("" if number == 1 else "s")
