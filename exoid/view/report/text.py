"""Sentences and tables in the report of an identification."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.estimate.text import HEADERS, assumptions, influences, parameter_rows
from exoid.experiments.excitation import Advice, assess
from exoid.regression.trends import trend_warnings
from exoid.signals import Recording
from exoid.tables import DataTable, with_error

from .evidence import Evidence

GOOD_NRMSE = 0.1
"""A joint whose torque is predicted to this part of its spread is predicted well."""

SAID = {
    "well": "well determined",
    "weakly": "weakly determined",
    "not": "not determined",
    "prior": "known better from a prior than from the recordings",
    "known": "held at what is known",
}
"""Verdicts on parameters."""

POOR = ("weakly", "not")
"""Those which more recordings would mend."""

BAND = (
    "The band is where 95 % of newly measured torques are expected if the model is right: it has the errors of the "
    "parameters and a residual as large as that of the fit. Measured and predicted torque have passed the same filter. "
    "A share far below 95 % in the table says that the model, or the leg, is another there."
)
"""Above the figures of torque."""

FRICTION = (
    "Points in the joint's colour are measured torque less all that the model says beside friction; in blue, what its "
    "friction terms say of the same samples. Both have passed the filter, which rounds the step at a reversal."
)
"""Above the figures of friction."""

ADVICE = (
    "What would help. Percentages are the standard deviation to expect over the size of the parameter (its value, or a "
    "tenth of what would explain all torque of a joint alone), with noise such as the residuals and nothing else known."
)
"""Above experiments to add."""


def summary(estimate: Estimate, tested: Sequence[Evidence]) -> list[str]:
    """Say how much is determined, how well unseen recordings are predicted, and what to beware of."""
    judged = estimate.identifiability
    counts = ", ".join(f"{judged.count(word)} {said}" for word, said in SAID.items() if judged.count(word))
    lines = [f"{len(judged)} parameters: {counts}."]
    for evidence in tested:
        errors = evidence.validation.nrmse
        joints = ", ".join(f"{joint} {100 * e:.1f} %" for joint, e in zip(estimate.joint_names, errors, strict=True))
        judgement = "predicts well" if (errors <= GOOD_NRMSE).all() else "does not predict every joint well"
        lines.append(
            f"On {evidence.validation.source}, which it was not fitted to, it {judgement} "
            f"(torque error over the spread of the torque: {joints})."
        )
    if not tested:
        lines.append("It was not tested on a recording that it has not seen: the errors below are of the fit itself.")
    return lines + [f"Warning: {warning}." for warning in estimate.warnings]


def parameter_table(estimate: Estimate, beside: Mapping[str, Mapping[str, float]]) -> DataTable:
    """Table of parameters and fitted settings, with other values beside them."""
    rows = [
        (*row, *(f"{values[row[0]]:.4g}" if row[0] in values else "–" for values in beside.values()))
        for row in parameter_rows(estimate)
    ]
    caption = f"{estimate.estimator} estimate, condition number {estimate.condition_number:.1f}"
    return DataTable(caption, (*HEADERS, *beside), rows)


def error_table(estimate: Estimate, evidence: Sequence[Evidence], held_out: bool) -> DataTable:
    """Table of prediction errors, and of how much the band contains."""
    rows = [
        (e.validation.source, joint, f"{rmse:.4g}", f"{100 * nrmse:.2f}", f"{r2:.4f}", f"{100 * inside:.1f}")
        for e in evidence
        for joint, rmse, nrmse, r2, inside in zip(
            estimate.model.leg.joint_labels,
            e.validation.rmse,
            e.validation.nrmse,
            e.validation.r2,
            e.inside,
            strict=True,
        )
    ]
    caption = "Not seen by the fit" if held_out else "The fit's own recordings"
    return DataTable(caption, ("recording", "joint", "RMSE [N·m]", "NRMSE [%]", "R²", "in 95 % band [%]"), rows)


def trend_table(estimate: Estimate) -> DataTable:
    """Table of whether residuals depend on velocity and angle."""
    rows = []
    for trend in estimate.trends:
        by_noise = "yes" if not trend.significant else "no" if trend.matters else "no, but a trifle"
        rows.append((trend.joint, trend.against, f"{100 * trend.share:.2g}", f"{trend.p_value:.1g}", by_noise))
    headers = ("joint", "residual against", "of its torque [%]", "p", "noise explains it")
    return DataTable("Mean residuals of the fit's own recordings", headers, rows)


def dependence(estimate: Estimate) -> list[str]:
    """Say which residuals depend on velocity or angle, and what that hints at."""
    if not estimate.trends:
        return [
            "There are too few independent samples to test whether residuals depend on velocity or angle. The bars "
            "below take all samples for independent and are too short."
        ]
    return [_sentence(remark) for remark in trend_warnings(estimate.trends)] or [
        "No residual depends on velocity or angle by more than noise explains and by more than 1 % of the torque."
    ]


def influence_parts(estimate: Estimate) -> Iterator[DataTable | list[str]]:
    """Say what each of several recordings contributes."""
    influence = estimate.influence
    if influence is None:
        return
    uncertain = estimate.std > 0.0
    rows = []
    for recording, change, share, expected in zip(*influence, strict=True):
        most = int(np.argmax(np.abs(change) / np.maximum(expected, 1.0)))
        moved = f"{change[most]:+.1f}".replace("-", "−") if np.isfinite(change[most]) else "not known without"
        part = "–" if len(estimate.nonlinear) else f"{100 * share[uncertain].mean():.0f}"  # settings share in it, too
        usual = f"{expected[most]:.1f}" if expected[most] > 0.0 else "–"
        rows.append((recording, part, estimate.names[most], moved, usual))
    headers = ("recording", "of what is known [%]", "without it, moves most", "by [std]", "by noise alone, typically")
    yield DataTable("What each recording contributes", headers, rows)
    if lines := [f"{line}." for line in influences(estimate)]:
        yield lines


def advice(estimate: Estimate, recordings: Sequence[Recording]) -> Iterator[list[str]]:
    """Name what is not well determined, what each such parameter trades against, and what to record."""
    correlation = np.abs(estimate.correlation - np.eye(len(estimate.names)))
    poor = [name for name, judged in zip(estimate.names, estimate.identifiability, strict=True) if judged in POOR]
    lines = []
    for name in poor:
        k = estimate.names.index(name)
        partner = int(correlation[k].argmax())
        lines.append(
            f"{name} is {SAID[estimate.identifiability[k]]} "
            f"({' ± '.join(with_error(estimate.values[k], estimate.std[k]))} {estimate.units[k]}); "
            f"it trades most against {estimate.names[partner]} "
            f"(correlation {estimate.correlation[k, partner]:+.2f})."
        )
    lines += [f"{doubt}." for doubt in estimate.nonlinear.warnings]
    if not lines:
        yield ["Every parameter is well determined. A recording that the fit has not seen tests the model."]
        return
    yield lines
    if experiments := list(_experiments(estimate, recordings, poor)):
        yield [ADVICE]
        yield experiments
    else:
        yield ["Record motions in which what trades against each other differs; exoid plan finds them."]


def _experiments(estimate: Estimate, recordings: Sequence[Recording], poor: Sequence[str]) -> Iterator[str]:
    """Try simple experiments, with noise of the size and the independence of the residuals; none where that fails."""
    seconds = sum(recording.duration for recording in recordings)
    counts = [noise.effective_samples for noise in estimate.noise if np.isfinite(noise.effective_samples)]
    try:
        found = assess(
            estimate.model.leg,
            recordings,
            estimate.model.terms,
            noise=estimate.residual_rms,
            noise_bandwidth=min(counts) / seconds / 2.0 if counts else np.inf,
            values=dict(zip(estimate.names, estimate.values.tolist(), strict=True)),
            preparation=estimate.preparation,
        )
    except ExoidError:  # as with limits between which nothing is left: the rest of the report stands
        return
    for each in found.advice:
        kept = [k for k, name in enumerate(each.parameters) if name in poor]
        if kept:
            names = tuple(each.parameters[k] for k in kept)
            before, after = (tuple(row[k] for k in kept) for row in (each.before, each.after))
            yield _sentence(str(Advice(each.what, names, before, after)))


def inputs(estimate: Estimate) -> DataTable:
    """Table of what was identified from."""
    rows = [(i.name, f"{i.samples}", f"{i.sample_rate:.4g}", i.sha256) for i in estimate.inputs]
    return DataTable("Recordings", ("name", "samples", "rate [Hz]", "sha256"), rows)


def settings(estimate: Estimate) -> list[str]:
    """Say how it was identified, and what entered beside the recordings."""
    terms = ", ".join(dict.fromkeys(type(term).__name__ for term in estimate.model.terms)) or "none"
    preparation = ", ".join(f"{key} {value}" for key, value in estimate.preparation.describe().items())
    return [
        f"Estimator: {estimate.estimator}; {estimate.dof:.0f} degrees of freedom.",
        f"Terms beside the rigid bodies: {terms}.",
        f"Preparation: {preparation}.",
        *map(_sentence, assumptions(estimate.prior_knowledge, estimate.bounded)),
        *(f"{regrouped}." for regrouped in estimate.regrouped),
    ]


def _sentence(words: str) -> str:
    return f"{words[:1].upper()}{words[1:]}."
