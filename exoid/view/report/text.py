"""Sentences and tables in the report of an identification."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from exoid.actuators import describe_actuators
from exoid.estimate import Estimate
from exoid.estimate.finding import finding_lines, findings_table
from exoid.estimate.text import assumptions, compared_table, influences, parameter_rows
from exoid.estimate.verdict import verdict_line
from exoid.regression.trends import trend_warnings
from exoid.tools.tables import DataTable

from .page import Block, Text
from .recording_prediction import RecordingPrediction

GOOD_NRMSE = 0.1
"""Largest NRMSE of a joint that counts as predicted well."""

IDENTIFIABILITY = {
    "well": "well identified",
    "weakly": "weakly identified",
    "not": "not identified",
    "prior": "known mainly from the prior",
    "known": "fixed at a known value",
}
"""Text of each class of identifiability."""

BAND_NOTE = (
    "If the model is right, the band contains 95 % of newly measured torques. It includes the errors of the "
    "parameters, a residual as large as that of the fit, and doubt about the form of friction. Measured torque, "
    "predicted torque and band passed the same filter. A share far below 95 % in the table shows that the model is "
    "wrong for this recording, or that the leg has changed."
)
"""Text above the figures of torque."""

FRICTION_NOTE = (
    "Dots in the joint's colour are measured torque less all modelled torque except friction. Violet dots are the "
    "friction terms of the model at the same samples. Both passed the filter, which rounds the step at a reversal."
)
"""Text above the figures of friction."""


def summary(estimate: Estimate, tested: Sequence[RecordingPrediction]) -> list[str]:
    """Summarise the identifiability of parameters, the prediction of held-out recordings, and warnings."""
    grades = estimate.identifiability
    bad = [finding for finding in estimate.findings if finding.severity != "info"]
    counts = ", ".join(f"{grades.count(grade)} {text}" for grade, text in IDENTIFIABILITY.items() if grade in grades)
    lines = [f"{len(grades)} parameters: {counts}."]
    for prediction in tested:
        nrmse = prediction.validation.nrmse
        known = np.isfinite(nrmse)
        joints = ", ".join(
            f"{joint} {e:.3f}" if there else f"{joint} not measured"
            for joint, e, there in zip(estimate.joint_names, nrmse, known, strict=True)
        )
        quality = "predicts well" if (nrmse[known] <= GOOD_NRMSE).all() else "does not predict every joint well"
        lines.append(
            f"On the held-out recording {prediction.validation.source} the estimate {quality} (NRMSE, the RMS error "
            f"over the standard deviation of the torque: {joints})."
        )
        if prediction.validation.findings:
            lines.append(sentence(verdict_line(prediction.validation.findings)))
    if not tested:
        lines.append("There is no held-out recording: the errors below are those of the fit.")
    lines += [f"{finding.kind}{f' at {finding.joint}' if finding.joint else ''}: {finding.message}." for finding in bad]
    return lines + [f"Warning: {warning}." for warning in estimate.warnings]


def finding_blocks(estimate: Estimate) -> Iterator[Block]:
    """Table of findings, and what each means; nothing where there are none."""
    if estimate.findings:
        yield findings_table(estimate.findings)
        yield Text([sentence(line) for line in finding_lines(estimate.findings)])


def parameter_table(estimate: Estimate, other_values: Mapping[str, Mapping[str, float]]) -> DataTable:
    """Table of linear and nonlinear parameters, with other values by label and name."""
    caption = f"{estimate.estimator} estimate, condition number {estimate.condition_number:.1f}"
    return compared_table(caption, parameter_rows(estimate), other_values)


def error_table(estimate: Estimate, predictions: Sequence[RecordingPrediction], held_out: bool) -> DataTable:
    """Table of prediction errors, and of the coverage of the prediction band."""
    rows = [
        (
            p.validation.source,
            joint,
            *(
                "–" if np.isnan(value) else text
                for value, text in (
                    (rmse, f"{rmse:.4g}"),
                    (nrmse, f"{nrmse:.4f}"),
                    (r2, f"{r2:.4f}"),
                    (coverage, f"{100 * coverage:.1f}"),
                )
            ),
        )
        for p in predictions
        for joint, rmse, nrmse, r2, coverage in zip(
            estimate.model.leg.joint_labels,
            p.validation.rmse,
            p.validation.nrmse,
            p.validation.r2,
            p.coverage,
            strict=True,
        )
    ]
    caption = "Held-out recordings" if held_out else "Recordings of the fit"
    return DataTable(caption, ("recording", "joint", "RMSE [N·m]", "NRMSE", "R²", "in 95 % band [%]"), rows)


def trend_table(estimate: Estimate) -> DataTable:
    """Table of the tests whether residuals depend on velocity or angle."""
    rows = []
    for trend in estimate.trends:
        by_noise = "yes" if not trend.significant else "no" if trend.matters else "no, but negligible"
        rows.append((trend.joint, trend.against, f"{100 * trend.share:.2g}", f"{trend.p_value:.1g}", by_noise))
    headers = ("joint", "residual against", "share of torque [%]", "p-value", "explained by noise")
    return DataTable("Mean residuals of the recordings of the fit", headers, rows)


def trend_notes(estimate: Estimate) -> Text:
    """Name the residuals that depend on velocity or angle, with a hint at the missing term."""
    if not estimate.trends:
        return Text(
            [
                "There are too few independent samples to test whether residuals depend on velocity or angle. The "
                "error bars below assume independent samples, and are too short."
            ]
        )
    return Text(
        [sentence(warning) for warning in trend_warnings(estimate.trends)]
        or ["No residual depends on velocity or angle by more than noise explains and by more than 1 % of the torque."]
    )


def influence_blocks(estimate: Estimate) -> Iterator[Block]:
    """Table and notes on the influence of each of several recordings; nothing for a single recording."""
    influence = estimate.influence
    if influence is None:
        return
    uncertain = estimate.std > 0.0
    rows = []
    for recording, change, share, expected in zip(*influence, strict=True):
        most = int(np.argmax(np.abs(change) / np.maximum(expected, 1.0)))
        largest = f"{change[most]:+.1f}".replace("-", "−") if np.isfinite(change[most]) else "not identifiable"
        # Nonlinear parameters also take a share of the information, which is not known.
        mean_share = "–" if len(estimate.nonlinear) else f"{100 * share[uncertain].mean():.0f}"
        by_noise = f"{expected[most]:.1f}" if expected[most] > 0.0 else "–"
        rows.append((recording, mean_share, estimate.names[most], largest, by_noise))
    headers = (
        "left-out recording",
        "share of information [%]",
        "parameter that changes most",
        "change [std]",
        "expected from noise [std]",
    )
    yield DataTable("Influence of each recording", headers, rows)
    if lines := [f"{line}." for line in influences(estimate)]:
        yield Text(lines)


def input_table(estimate: Estimate) -> DataTable:
    """Table of the recordings of the fit."""
    rows: list[tuple[str, ...]] = [(i.label, f"{i.samples}", f"{i.sample_rate:.4g}", i.sha256) for i in estimate.inputs]
    headers: tuple[str, ...] = ("name", "samples", "rate [Hz]", "sha256")
    if any(i.moving_base for i in estimate.inputs):
        headers = (*headers, "base")
        bases = ("moves" if i.moving_base else "at rest" for i in estimate.inputs)
        rows = [(*row, base) for row, base in zip(rows, bases, strict=True)]
    return DataTable("Recordings", headers, rows)


def drive_blocks(estimate: Estimate) -> Iterator[Text]:
    """Describe the drives of which torques were computed."""
    if estimate.actuators is not None:
        lines = describe_actuators(estimate.actuators)
        yield Text(["Torques were computed of what these drives measured.", *lines])


def settings(estimate: Estimate) -> Text:
    """Settings of the identification, and the prior knowledge that entered it."""
    terms = ", ".join(dict.fromkeys(type(term).__name__ for term in estimate.model.terms)) or "none"
    described = estimate.preparation.describe()
    preparation = ", ".join([str(described.pop("name")), *(_setting(key, value) for key, value in described.items())])
    return Text(
        [
            f"Estimator: {estimate.estimator}; {estimate.dof:.0f} degrees of freedom.",
            f"Torque terms besides the rigid bodies: {terms}.",
            f"Preparation: {preparation}.",
            *map(sentence, assumptions(estimate.prior_knowledge, estimate.bounded)),
            *(f"{regrouped}." for regrouped in estimate.regrouped),
        ]
    )


def _setting(name: str, value: object) -> str:
    """Write a setting of the preparation, frequencies with their unit."""
    number = f"{value:g}" if isinstance(value, float) else str(value)
    return f"{name.replace('_', ' ')} {number}{' Hz' if name.endswith('cutoff') and isinstance(value, float) else ''}"


def sentence(clause: str) -> str:
    """Make a clause a sentence: a capital letter first, a full stop last."""
    return f"{clause[:1].upper()}{clause[1:]}."
