"""Where the values of an estimate come from, in lines of text for a comment."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from exoid._typing import FloatArray
from exoid.signals import Preparation
from exoid.torques import Regrouped


class InputSource(Protocol):
    """A recording that values were identified from, such as :class:`exoid.identification.Input`."""

    @property
    def name(self) -> str:
        """Name of the file."""

    @property
    def sha256(self) -> str:
        """Hash of the file."""

    @property
    def samples(self) -> int:
        """Number of samples."""

    @property
    def sample_rate(self) -> float:
        """Samples per second [Hz]."""


class Identified(Protocol):
    """What the provenance of values tells of them: attributes of :class:`exoid.Estimate`."""

    @property
    def estimator(self) -> str:
        """Name of the estimator."""

    @property
    def preparation(self) -> Preparation:
        """How the recordings became rows."""

    @property
    def condition_number(self) -> float:
        """Condition number of the regressor, columns scaled."""

    @property
    def inputs(self) -> Sequence[InputSource]:
        """Recordings."""

    @property
    def warnings(self) -> Sequence[str]:
        """What makes the values doubtful."""

    @property
    def regrouped(self) -> Sequence[Regrouped]:
        """Parameters that are part of others."""

    @property
    def names(self) -> Sequence[str]:
        """Names of the parameters, P of them."""

    @property
    def units(self) -> Sequence[str]:
        """Units of the parameters, P of them."""

    @property
    def values(self) -> FloatArray:
        """Values of the parameters, (P,)."""

    @property
    def std(self) -> FloatArray:
        """Standard deviations of the parameters, (P,)."""

    @property
    def identifiability(self) -> Sequence[str]:
        """How well each parameter is determined, P of them."""


def provenance(identified: Identified) -> list[str]:
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
