"""The report of an identification: what was found, how far to trust it, and what to record next."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from exoid._typing import FloatArray
from exoid.identification import Estimate, Validation, validate
from exoid.signals import Recording
from exoid.tables import DataTable, with_error
from exoid.view.coverage import plot_coverage, plot_excitation
from exoid.view.parameters import plot_correlation, plot_parameters
from exoid.view.residuals import plot_prediction, plot_residual_along

from .page import Page, Part, Picture, Section, Words, picture

SHOWN = 20.0
"""Of a recording [s], as torque over time."""

GOOD_NRMSE = 0.1
"""A joint whose torque is predicted to this part of its spread is predicted well."""


class Evidence(NamedTuple):
    """A recording, the motion in it and how well its torque is predicted."""

    recording: Recording
    q: FloatArray
    v: FloatArray
    validation: Validation


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
        ExoidError: A recording lacks torque or a joint of the leg.
    """
    if beside is None:
        leg = estimate.model.leg
        beside = {"URDF": dict(zip(leg.parameter_names, leg.parameters.tolist(), strict=True))}
    fitted = [_evidence(estimate, recording) for recording in recordings]
    tested = [_evidence(estimate, recording) for recording in held_out]
    sections = [
        Section("Parameters", [_parameter_table(estimate, beside), *_parameter_pictures(estimate, beside)]),
        Section("Measured and predicted torque", list(_torque_parts(estimate, tested or fitted, bool(tested)))),
        Section("What the model leaves over", list(_residual_pictures(estimate, tested or fitted))),
        Section("What the motion excites", list(_excitation_pictures(estimate, fitted))),
        Section("What to record next", [Words(_advice(estimate))]),
        Section("From what, and how", [_inputs(estimate), Words(_settings(estimate))]),
    ]
    title = f"{estimate.model.leg.description.name}: identified from {_count(len(estimate.inputs), 'recording')}"
    return Page(title, _verdict(estimate, tested), sections)


def _evidence(estimate: Estimate, recording: Recording) -> Evidence:
    joints = estimate.joint_names if set(estimate.joint_names) <= set(recording.joint_names) else None
    selected = recording.select(joints or estimate.model.leg.joint_labels).resampled()
    q, v, _, valid = estimate.preparation.kinematics(selected)
    return Evidence(selected, q[valid], v[valid], validate(estimate, recording))


def _verdict(estimate: Estimate, tested: Sequence[Evidence]) -> list[str]:
    judged = estimate.verdicts
    counts = ", ".join(f"{judged.count(word)} {said}" for word, said in SAID.items() if judged.count(word))
    lines = [f"{len(judged)} parameters: {counts}."]
    for evidence in tested:
        errors = evidence.validation.nrmse
        joints = ", ".join(f"{joint} {100 * e:.1f} %" for joint, e in zip(estimate.joint_names, errors, strict=True))
        judgement = "predicts well" if (errors <= GOOD_NRMSE).all() else "does not predict every joint well:"
        lines.append(
            f"On {evidence.validation.source}, which it was not fitted to, it {judgement} "
            f"(torque error over the spread of the torque: {joints})."
        )
    if not tested:
        lines.append("It was not tested on a recording that it has not seen: the errors below are of the fit itself.")
    return lines + [f"Warning: {warning}." for warning in estimate.warnings]


SAID = {"well": "well determined", "weakly": "weakly determined", "not": "not determined"}


def _parameter_table(estimate: Estimate, beside: Mapping[str, Mapping[str, float]]) -> DataTable:
    rows = [
        (
            name,
            *with_error(value, std, *interval),
            unit,
            judged,
            *(f"{values[name]:.4g}" if name in values else "–" for values in beside.values()),
        )
        for name, value, std, interval, unit, judged in zip(
            estimate.names,
            estimate.values,
            estimate.std,
            estimate.interval(),
            estimate.units,
            estimate.verdicts,
            strict=True,
        )
    ]
    headers = ("parameter", "value", "± std", "95 % from", "to", "unit", "determined", *beside)
    caption = f"{estimate.estimator} estimate, condition number {estimate.condition_number:.1f}"
    return DataTable(caption, headers, rows)


def _parameter_pictures(estimate: Estimate, beside: Mapping[str, Mapping[str, float]]) -> Iterator[Part]:
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


def _torque_parts(estimate: Estimate, evidence: Sequence[Evidence], held_out: bool) -> Iterator[Part]:
    labels = estimate.model.leg.joint_labels
    rows = [
        (e.validation.source, joint, f"{rmse:.4g}", f"{100 * nrmse:.2f}", f"{r2:.4f}")
        for e in evidence
        for joint, rmse, nrmse, r2 in zip(labels, e.validation.rmse, e.validation.nrmse, e.validation.r2, strict=True)
    ]
    caption = "Not seen by the fit" if held_out else "The fit's own recordings"
    yield DataTable(caption, ("recording", "joint", "RMSE [N·m]", "NRMSE [%]", "R²"), rows)
    for joint, label in enumerate(labels):
        yield picture(
            partial(_draw_prediction, validation=evidence[0].validation, joint=joint, label=label),
            f"Measured and predicted {label} torque over time with the residual",
            f"{label}, the first {SHOWN:.0f} s of {evidence[0].validation.source}",
        )


def _draw_prediction(figure: Figure, validation: Validation, joint: int, label: str) -> None:
    time = validation.time - validation.time[0]
    shown = time < SHOWN
    measured, predicted = validation.measured[shown, joint], validation.predicted[shown, joint]
    plot_prediction(figure.add_subplot(), time[shown], measured, predicted, label)


def _residual_pictures(estimate: Estimate, evidence: Sequence[Evidence]) -> Iterator[Picture]:
    q, v = (np.concatenate([getattr(e, name) for e in evidence]) for name in ("q", "v"))
    residual = np.concatenate([e.validation.residual for e in evidence])
    for joint, label in enumerate(estimate.model.leg.joint_labels):
        for x, name in ((v[:, joint], "velocity [rad/s]"), (np.rad2deg(q[:, joint]), "angle [deg]")):
            yield picture(
                partial(_draw_residual, x=x, residual=residual[:, joint], joint=joint, name=name, label=label),
                f"Residual {label} torque against {label} {name}",
            )


def _draw_residual(figure: Figure, x: FloatArray, residual: FloatArray, joint: int, name: str, label: str) -> None:
    plot_residual_along(figure.add_subplot(), x, residual, joint, f"{label} {name}", label)


def _excitation_pictures(estimate: Estimate, evidence: Sequence[Evidence]) -> Iterator[Picture]:
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


def _draw_excitation(figure: Figure, q: FloatArray, v: FloatArray, joint: int, label: str) -> None:
    plot_excitation(figure.add_subplot(), q, v, joint, label)


def _draw_coverage(
    figure: Figure, q: FloatArray, labels: tuple[str, str], limits: tuple[FloatArray, FloatArray]
) -> None:
    plot_coverage(figure.add_subplot(), q, labels, limits)


def _advice(estimate: Estimate) -> list[str]:
    """Name what is not well determined, and what each such parameter trades against."""
    correlation = np.abs(estimate.correlation - np.eye(len(estimate.names)))
    lines = []
    for k, (name, judged) in enumerate(zip(estimate.names, estimate.verdicts, strict=True)):
        if judged == "well":
            continue
        partner = int(correlation[k].argmax())
        lines.append(
            f"{name} is {SAID[judged]} ({' ± '.join(with_error(estimate.values[k], estimate.std[k]))} "
            f"{estimate.units[k]}); it trades most against {estimate.names[partner]} "
            f"(correlation {estimate.correlation[k, partner]:+.2f}): record a motion in which the two differ."
        )
    return lines or ["Every parameter is well determined. A recording that the fit has not seen tests the model."]


def _inputs(estimate: Estimate) -> DataTable:
    rows = [(i.name, f"{i.samples}", f"{i.sample_rate:.4g}", i.sha256) for i in estimate.inputs]
    return DataTable("Recordings", ("name", "samples", "rate [Hz]", "sha256"), rows)


def _settings(estimate: Estimate) -> list[str]:
    terms = ", ".join(type(term).__name__ for term in estimate.model.terms) or "none"
    settings = ", ".join(f"{key} {value}" for key, value in estimate.preparation.describe().items())
    return [
        f"Estimator: {estimate.estimator}; {estimate.dof:.0f} degrees of freedom.",
        f"Terms beside the rigid bodies: {terms}.",
        f"Preparation: {settings}.",
        *(f"{merged}." for merged in estimate.merged),
    ]


def _count(number: int, what: str) -> str:
    return f"{number} {what}" + ("" if number == 1 else "s")
