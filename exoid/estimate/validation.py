"""How well an estimate predicts the torque of a recording it was not fitted to."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from exoid._typing import FloatArray
from exoid.actuators import Actuators, Coupling, Drive
from exoid.regression.intervals import half_width
from exoid.regression.rows import prepare
from exoid.signals import Recording
from exoid.signals.contacts import stands
from exoid.tools.json_values import json_value
from exoid.tools.read_only import ReadOnly
from exoid.tools.tables import DataTable, Report, with_parts
from exoid.torques.position_units import PositionUnit, heading, position_units

from .compared import Compared, TorqueFilter, compare_rows, to_predict, wrench_variance
from .data import EstimateData
from .evidence import MotionRanges
from .finding import Finding, Verdict, ordered, verdict_line, verdict_of
from .ground_validation import compare_on_ground
from .validation_checks import (
    extrapolations,
    late_torques,
    narrow_bands,
    poor_predictions,
    unmeasured_torques,
    wide_bands,
)


@dataclass(frozen=True, eq=False, repr=False)
class Validation(ReadOnly, Report):
    """Measured and predicted torque, filtered alike, and what lies between them.

    Attributes:
        joint_names: Joints, (n,).
        time: [s], (N,).
        measured: Filtered measured torque [N·m], (N, n); not a number where the torque of a joint was not measured.
        predicted: Filtered predicted torque [N·m], (N, n), W β − Σ Jᵀ w with the wrenches w that were measured.
        source: Name of the recording, or of all.
        parts: Validation of each recording where there are several; samples of all follow each other above.
        findings: Motion beyond that of the training, velocity that is late, and torque that is late or not predicted.
        half_width: Half the width of the 95 % band of the filtered measured torque [N·m], (N, n): errors of parameters
            and of the form of friction, and noise of torques and of force plates.
        filter: Filter of both torques.
        wrench_torque: Part of both torques that is that of measured wrenches, −Σ Jᵀ w, with that of payloads [N·m],
            (N, n); zero without wrenches.
        units: Units of each joint, (n,).
    """

    joint_names: tuple[str, ...]
    time: FloatArray
    measured: FloatArray
    predicted: FloatArray
    source: str
    parts: tuple[Validation, ...] = ()
    findings: tuple[Finding, ...] = ()
    half_width: FloatArray = field(kw_only=True)
    filter: TorqueFilter = field(kw_only=True)
    wrench_torque: FloatArray = field(kw_only=True)
    units: tuple[PositionUnit, ...] = field(kw_only=True)

    @property
    def residual(self) -> FloatArray:
        """Measured less predicted torque [N·m], (N, n)."""
        return self.measured - self.predicted

    @property
    def rmse(self) -> FloatArray:
        """Root of the mean squared residual [N·m], (n,); not a number for a joint whose torque was not measured."""
        return np.asarray(np.sqrt(_mean(self.residual**2)))

    @property
    def nrmse(self) -> FloatArray:
        """RMSE over the standard deviation of the measured torque, (n,); not a number where that is constant."""
        return _over_spread(self.rmse, self.measured)

    @property
    def leg_nrmse(self) -> FloatArray:
        """RMSE over the standard deviation of the torque less that of measured wrenches, which is known, (n,)."""
        return _over_spread(self.rmse, self.measured - self.wrench_torque)

    @property
    def r2(self) -> FloatArray:
        """Coefficient of determination 1 − Σ residual² / Σ (measured − mean)², (n,)."""
        return 1.0 - self.nrmse**2

    @property
    def coverage(self) -> FloatArray:
        """Share of the samples whose measured torque is inside the 95 % band, (n,)."""
        inside = (np.abs(self.residual) <= self.half_width).astype(np.float64)
        return _mean(np.where(np.isnan(self.residual), np.nan, inside))

    @property
    def verdict(self) -> Verdict:
        """Verdict by the findings: "predicts", "predicts poorly" or "does not predict"; see docs/validation.md."""
        return verdict_of(self.findings)

    def to_json(self) -> dict[str, Any]:
        """Turn the figures of a validation into what JSON can hold.

        Returns:
            Source, verdict, number of samples, filter, joints and their RMSE [N·m], NRMSE, R² and share inside the
            band, and findings; the same of each recording where there are several.
        """
        parts = {"recordings": [part.to_json() for part in self.parts]} if self.parts else {}
        return {
            "source": self.source,
            "verdict": self.verdict,
            "cutoff": self.filter.cutoff,
            "cutoff_source": self.filter.source,
            "cutoff_of_estimate": self.filter.chosen,
            "samples": len(self.time),
            "joint_names": list(self.joint_names),
            "torque_units": [unit.torque for unit in self.units],
            "rmse": json_value(self.rmse),
            "nrmse": json_value(self.nrmse),
            "leg_nrmse": json_value(self.leg_nrmse),
            "r2": json_value(self.r2),
            "coverage_95": json_value(self.coverage),
            "findings": json_value(self.findings),
            **parts,
        }

    def __repr__(self) -> str:
        """Name the joints and their NRMSE."""
        each = zip(self.joint_names, self.nrmse, self.rmse, strict=True)
        errors = ", ".join(f"{n} not measured" if np.isnan(rms) else f"{n} {e:.3f}" for n, e, rms in each)
        return f"Validation(nrmse: {errors})"

    def _report(self) -> list[DataTable | str]:
        """Title, tables and number of samples."""
        samples = f"{len(self.time)} samples, both torques {self.filter}"
        tables = with_parts(self.headers, self.rows(), [(part.source, part.rows()) for part in self.parts])
        return [f"Prediction of {self.source}", *tables, samples, *map(str, self.findings), verdict_line(self.findings)]

    @property
    def headers(self) -> tuple[str, ...]:
        """Columns of :meth:`rows`."""
        return ("joint", f"RMSE [{heading(self.units, '{torque}')}]", "NRMSE", "R²", "in 95 % band")

    def rows(self) -> list[tuple[str, ...]]:
        """Write joint, RMSE, NRMSE, R² and share inside the band as rows of a table.

        Returns:
            One row a joint.
        """
        columns = (self.joint_names, self.rmse, self.nrmse, self.leg_nrmse, self.r2, self.coverage)
        return [
            (name, "not measured", "", "", "")
            if np.isnan(e)
            else (name, f"{e:.4g}", _ratio(n, leg), _ratio(r), f"{100.0 * c:.1f} %")
            for name, e, n, leg, r, c in zip(*columns, strict=True)
        ]


def _ratio(value: float, of_leg: float = 0.0) -> str:
    """Write a ratio to the spread of the torque, which a passive joint has not; and that of the leg if far larger."""
    more = f" (leg {of_leg:.4f})" if 0.0 < 1.2 * value < of_leg else ""
    return "–" if np.isnan(value) else f"{value:.4f}{more}"


def _over_spread(size: FloatArray, torque: FloatArray) -> FloatArray:
    """Sizes over the standard deviations of torques, (n,); not a number where that is rounding."""
    spread = np.sqrt(_mean((torque - _mean(torque)) ** 2))
    changes = spread > 1e-9 * np.sqrt(_mean(torque**2))
    return np.asarray(np.divide(size, spread, out=np.full(len(spread), np.nan), where=changes))


def _mean(x: FloatArray) -> FloatArray:
    """Mean of the samples that were measured, (n,); not a number where there is none."""
    there = ~np.isnan(x)
    if there.all():
        return np.asarray(x.mean(axis=0))
    count = there.sum(axis=0)
    total = np.where(there, x, 0.0).sum(axis=0)
    return np.asarray(np.divide(total, count, out=np.full(x.shape[1], np.nan), where=count > 0))


def validate(
    estimate: EstimateData,
    recordings: Recording | Iterable[Recording],
    *,
    cutoff: float | None = None,
    actuators: Mapping[str, Drive | Coupling] | Actuators | None = None,
) -> Validation:
    """Predict the torque of one or several recordings and compare.

    NRMSE depends on the cut-off. To compare two estimates, pass the same ``cutoff`` for both: motion and torques then
    pass the same filters, whatever the estimates were identified with.

    Torques are shifted by the delays that the estimate found (``identify(delay="auto")``), and logged velocities that
    are late are left out, as :func:`exoid.identify` does; a finding says so.

    Args:
        estimate: The estimate.
        recordings: Motions with torques, better none that the estimate was fitted to.
        cutoff: Cut-off frequency of both torques [Hz]; None for the estimate's own preparation.
        actuators: Drives of the recordings, as for :func:`exoid.identify`; None for those of the estimate.

    Returns:
        Measured and predicted torque with RMSE, NRMSE, R² and share inside the 95 % band of each joint, over all
        recordings and of each, with findings and a verdict.

    Raises:
        ExoidError: There is no recording, or one lacks a joint or the torque or is too short for the filter.

    Example:
        >>> data = exoid.datasets.bleex_swing()
        >>> validation = exoid.validate(exoid.identify(data.leg, data.train), data.test)
        >>> bool((validation.nrmse < 0.07).all())
        True
        >>> validation.verdict
        'predicts'
    """
    estimate, several, chosen = to_predict(estimate, recordings, actuators, cutoff)
    parts = tuple(_validate_one(estimate, *each, chosen) for each in several)
    if len(parts) == 1:
        return parts[0]
    names = "time", "measured", "predicted", "half_width", "wrench_torque"
    whole: dict[str, Any] = {name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
    source = ", ".join(part.source for part in parts)
    findings = ordered([finding for part in parts for finding in part.findings])
    return replace(parts[0], **whole, source=source, parts=parts, findings=findings)


def _validate_one(
    estimate: EstimateData, recording: Recording, found: Sequence[Finding], chosen: TorqueFilter
) -> Validation:
    """Predict the torque of one recording, in which something was found already."""
    data, preparation = estimate.model.select(recording), chosen.preparation
    rate = data.sample_rate
    bandwidth = preparation.independent_fraction(rate) / estimate.preparation.independent_fraction(rate)
    if stands(estimate.model.leg, recording):
        compared, ranges = compare_on_ground(estimate, recording, preparation, bandwidth)
    else:
        prepared = prepare(estimate.band_model, data, preparation, every=True)
        parts = (part for _, part in compare_rows(estimate, prepared, data, preparation, bandwidth))
        compared = Compared(*(np.concatenate(part) for part in zip(*parts, strict=True)))
        ranges = MotionRanges.of(prepared.motion, prepared.inside)
    time, measured, predicted, variance, known = compared
    measured[:, ~data.measured] = np.nan
    how: dict[str, Any] = {
        "half_width": half_width(0.95, estimate.dof) * np.sqrt(variance),
        "filter": chosen,
        "wrench_torque": known if recording.wrenches else np.zeros_like(known),
        "units": position_units(estimate.model.leg),
    }
    alone = Validation(estimate.joint_names, time, measured, predicted, data.file_name or "array", **how)
    every = (*found, *_findings(estimate, alone, data, ranges, bandwidth))
    return replace(alone, findings=ordered([replace(one, recording=data.file_name) for one in every]))


def _findings(
    estimate: EstimateData, alone: Validation, data: Recording, ranges: MotionRanges, bandwidth: float
) -> Iterator[Finding]:
    """Judge the prediction of one recording with such ranges of its motion."""
    preparation, residual_rms = alone.filter.preparation, alone.rmse
    yield from extrapolations(estimate, ranges)
    growth = np.ones_like(residual_rms)
    if alone.filter.comparable:
        # White noise of force plates is no growth of the residual.
        by_plates = wrench_variance(estimate, data, preparation, data.q).mean(axis=0)[estimate.model.leg.base_rows :]
        of_training = np.sqrt(bandwidth * estimate.residual_rms**2 + by_plates)
        growth = np.divide(residual_rms, of_training, out=growth, where=of_training > 0.0)
        independent = len(alone.time) * preparation.independent_fraction(data.sample_rate)
        coverage = np.where(estimate.trained, alone.coverage, np.nan)
        yield from narrow_bands(estimate, coverage, independent)
        yield from late_torques(estimate.joint_names, alone.time, alone.predicted, alone.residual, coverage)
    yield from unmeasured_torques(estimate, data.measured)
    width = np.sqrt(_mean(alone.half_width**2))
    yield from wide_bands(estimate, _over_spread(width, alone.measured - alone.wrench_torque), alone.coverage)
    yield from poor_predictions(estimate, alone.leg_nrmse, growth, np.isin(data.joint_names, data.passive))
