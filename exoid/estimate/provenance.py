"""Where the values of an estimate come from, in lines of text for a comment."""

from __future__ import annotations

from .data import EstimateData


def provenance(identified: EstimateData) -> list[str]:
    """Say what values were identified from, how, and how well."""
    lines = [
        f"Estimator: {identified.estimator}, {identified.preparation.name} preparation; condition number "
        f"{identified.condition_number:.1f}."
    ]
    for source in identified.inputs:
        lines.append(f"Data: {source.name}, {source.samples} samples at {source.sample_rate:g} Hz")
        lines.append(f"  sha256 {source.sha256}")
    lines += [f"Warning: {warning}" for warning in identified.warnings]
    lines += [f"Note: {regrouped}." for regrouped in identified.regrouped]
    parameters = zip(
        *(identified.names, identified.values, identified.std, identified.units, identified.identifiability),
        strict=True,
    )
    return [
        *(*lines, "", "Parameters, with their standard deviations:"),
        *(
            f"  {name} = {value:.6g} +- {std:.2g} {unit}, {how} determined"
            for name, value, std, unit, how in parameters
        ),
    ]
