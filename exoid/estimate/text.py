"""An estimate in words: a table, and what the reader should know before trusting it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from exoid._typing import FloatArray
from exoid.actuators.drive_data import describe_actuators
from exoid.regression.diagnostics import ILL_CONDITIONED, identifiability_class
from exoid.regression.parameters import PriorKnowledge
from exoid.signals import ZeroPhase
from exoid.tools.json_values import named
from exoid.tools.tables import DataTable, with_error

from .data import EstimateData
from .nonlinear import NonlinearParameters
from .parameter import ParameterTable

HEADERS = ("parameter", "value", "± std", "95 % from", "to", "unit", "class")
"""Of :func:`number_rows`."""


def report(estimate: EstimateData) -> list[DataTable | str]:
    """Describe an estimate by a title, a table of its parameters, and what the reader should know."""
    title = f"{estimate.model.leg.description.name}: {estimate.estimator} estimate of {len(estimate.names)} parameters"
    return [
        title,
        parameter_table(estimate),
        *below_parameters(estimate),
        fit_table(estimate),
        *_closing_lines(estimate),
    ]


def below_parameters(estimate: EstimateData) -> Iterator[str]:
    """Say below the table of parameters what J contains, and why some are not determined."""
    leg = estimate.model.leg
    if leg.cumulative and {"J1", "J2"} <= {name.partition("_")[0] for name in leg.parameter_names}:
        yield "J contains the J of the segments below: J1 − J2 is that of the first segment alone"
    yield from reasons(estimate)


def parameter_table(estimate: EstimateData, caption: str = "") -> DataTable:
    """Make a table of the parameters, then of fitted constants of drives, with the URDF's values beside them."""
    leg, nonlinear = estimate.model.leg, estimate.nonlinear
    given = dict(zip(leg.parameter_names, leg.parameters.tolist(), strict=True))
    settings = number_rows(nonlinear, nonlinear.interval(estimate.dof))
    rows = [*number_rows(estimate, estimate.interval()), *settings]
    compared = [(*row, f"{given[row[0]]:.4g}" if row[0] in given else "–") for row in rows]
    return DataTable(caption, (*HEADERS, "URDF"), compared)


def number_rows(of: ParameterTable | NonlinearParameters, intervals: FloatArray) -> list[tuple[str, ...]]:
    """Write the name and the numbers of each parameter under :data:`HEADERS`."""
    columns = (of.names, of.values, of.std, intervals, of.units, of.identifiability)
    rows = []
    for name, value, std, interval, unit, judged in zip(*columns, strict=True):
        # what is well determined, thus small in torque, and may as well be zero
        word = "about zero" if judged == "well" and interval[0] <= 0.0 <= interval[1] else judged
        rows.append((name, *written(value, std, interval), unit, word))
    return rows


def numbers_to_json(of: ParameterTable | NonlinearParameters, intervals: FloatArray) -> dict[str, Any]:
    """Turn the numbers of each parameter into what JSON can hold, by name."""
    keys = "values", "std", "interval_95", "units", "determined"
    columns = (of.values, of.std, intervals, of.units, of.identifiability)
    return {key: named(of.names, column) for key, column in zip(keys, columns, strict=True)}


def reasons(estimate: EstimateData) -> Iterator[str]:
    """Say why parameters are weakly or not determined where their standard deviations do not show it."""
    correlation = np.abs(estimate.correlation - np.eye(len(estimate.names)))
    by_reason: dict[str, list[str]] = {}
    sizes = (estimate.parameter_scale, estimate.reference_scale, estimate.collinearity)
    rows = zip(estimate.identifiability, estimate.values, estimate.std, *sizes, strict=True)
    for k, (judged, value, std, scale, reference, index) in enumerate(rows):
        if judged not in ("weakly", "not"):
            continue
        if judged == identifiability_class(value, std, max(scale, abs(value)), reference):
            continue  # the standard deviation alone says so
        found = [one.kind for one in estimate.findings if estimate.names[k] in one.parameters]
        reason = f"doubtful by {', '.join(dict.fromkeys(found))}"
        if identifiability_class(value, 0.0, scale, index=index) == judged:
            likely = [i for i in np.argsort(-correlation[k])[:2] if correlation[k, i] > 0.5 * correlation[k].max()]
            reason = f"confounded with {', '.join(estimate.names[i] for i in likely)}; ± counts noise only"
        by_reason.setdefault(f"{judged} determined: {reason}", []).append(estimate.names[k])
    yield from (f"{', '.join(names)} {reason}" for reason, names in by_reason.items())


def written(value: float, std: float, interval: FloatArray) -> tuple[str, ...]:
    """Write a value with what is uncertain of it; what is known or held has no uncertainty."""
    return with_error(value, std, *interval) if std > 0.0 else (f"{value:.6g}", "", "", "")


def fit_table(estimate: EstimateData) -> DataTable:
    """Make a table of the fit of each joint, without the figures that are not known."""
    headers = ["joint", f"residual RMS [{estimate.model.torque_unit}]"]
    columns = [[f"{rms:.3g}" for rms in estimate.residual_rms]]
    if estimate.evidence.torque_spread is not None:
        headers += ["NRMSE", "R²"]
        columns += [["–" if np.isnan(x) else f"{x:.4f}" for x in numbers] for numbers in (estimate.nrmse, estimate.r2)]
    if estimate.noise:
        headers += ["effective samples"]
        columns += [[f"{noise.effective_samples:.0f} of {noise.samples}" for noise in estimate.noise]]
    each = zip(estimate.joint_names, estimate.trained, *columns, strict=True)
    rows = [(x, *cells) if there else (x, "not measured", *("" for _ in cells[1:])) for x, there, *cells in each]
    return DataTable("", headers, rows)


def _closing_lines(estimate: EstimateData) -> Iterator[str]:
    yield from map(str, estimate.supports)
    yield f"{condition(estimate.condition_number)}; {estimate.dof:.0f} degrees of freedom"
    noises = zip(estimate.joint_names, estimate.noise, strict=False)
    # Residuals with a smaller probability of being white are said not to be
    if coloured := [joint for joint, noise in noises if noise.whiteness < 0.01]:
        yield f"residuals not white: {', '.join(coloured)}"
    names = ", ".join(source.label for source in estimate.inputs)
    samples = sum(source.samples for source in estimate.inputs)
    counted = f" ({samples} samples)" if samples else ""
    used, source = estimate.preparation, estimate.evidence.cutoff_source
    how = f" ({source})" if source else ""
    cutoff = f", cut-off {used.cutoff:.4g} Hz{how}" if isinstance(used, ZeroPhase) else ""
    yield f"from {names}{counted}; {used.name} preparation{cutoff}"
    if estimate.actuators is not None:
        yield f"torque computed of drives: {'; '.join(describe_actuators(estimate.actuators))}"
    yield from assumptions(estimate.prior_knowledge, estimate.bounded)
    yield from map(str, estimate.findings)
    yield from (f"warning: {warning}" for warning in estimate.warnings)
    yield from (f"note: {regrouped}" for regrouped in estimate.regrouped)


def condition(number: float) -> str:
    """Say a condition number, and what to do if it is large."""
    advice = "" if number < ILL_CONDITIONED else " (ill-conditioned: excite more, or plan a motion)"
    return f"condition number {number:.1f}{advice}"


def assumptions(prior_knowledge: PriorKnowledge, bounded: Sequence[str]) -> Iterator[str]:
    """Say what entered beside the recordings, and what was kept from falling below zero."""
    if prior_knowledge.known:
        yield "known: " + ", ".join(f"{name} = {value:.6g}" for name, value in prior_knowledge.known.items())
    if prior_knowledge.prior.values:
        pairs = prior_knowledge.prior.values.items()
        yield "prior: " + ", ".join(f"{name} = {value:.4g} ± {std:.2g}" for name, (value, std) in pairs)
    if bounded:
        yield f"kept at zero: {', '.join(bounded)}; intervals are as wide as without the bound"


def provenance(estimate: EstimateData) -> list[str]:
    """Say what values were estimate from, how, and how well."""
    lines = [
        f"Estimator: {estimate.estimator}, {estimate.preparation.name} preparation; condition number "
        f"{estimate.condition_number:.1f}."
    ]
    for source in estimate.inputs:
        lines.append(f"Data: {source.name}, {source.samples} samples at {source.sample_rate:g} Hz")
        lines.append(f"  sha256 {source.sha256}")
    lines += [f"Warning: {warning}" for warning in estimate.warnings]
    lines += [f"Note: {regrouped}." for regrouped in estimate.regrouped]
    rows = zip(estimate.names, estimate.values, estimate.std, estimate.units, estimate.identifiability, strict=True)
    return [
        *(*lines, "", "Parameters, with their standard deviations:"),
        *(f"  {name} = {value:.6g} +- {std:.2g} {unit}, {how} determined" for name, value, std, unit, how in rows),
    ]
