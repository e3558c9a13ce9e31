"""How well an estimate predicts the torque of a recording it was not fitted to."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.findings import Finding, finding_lines, findings_to_json, ordered
from exoid.regression.rows import form_rows, prepare
from exoid.signals import Preparation, Recording
from exoid.tables import DataTable, make_table, to_html, to_text

from .data import EstimateData
from .motion_ranges import MotionRanges
from .validation_checks import extrapolations, poor_predictions

HEADERS = ("joint", "RMSE [N·m]", "NRMSE", "R²")
"""Columns of :meth:`Validation.rows`."""


@dataclass(frozen=True, eq=False, repr=False)
class Validation:
    """Measured and predicted torque, filtered alike, and what lies between them.

    Attributes:
        joint_names: Joints, (n,).
        time: [s], (N,).
        measured: Filtered measured torque [N·m], (N, n).
        predicted: Filtered predicted torque [N·m], (N, n).
        source: Name of the recording, or of all.
        parts: Validation of each recording where there are several; samples of all follow each other above.
        findings: Motion beyond that of the training, and torque that is not predicted.
    """

    joint_names: tuple[str, ...]
    time: FloatArray
    measured: FloatArray
    predicted: FloatArray
    source: str
    parts: tuple[Validation, ...] = ()
    findings: tuple[Finding, ...] = ()

    def __post_init__(self) -> None:
        """Forbid changes."""
        for array in (self.time, self.measured, self.predicted):
            array.flags.writeable = False

    @property
    def residual(self) -> FloatArray:
        """Measured less predicted torque [N·m], (N, n)."""
        return self.measured - self.predicted

    @property
    def rmse(self) -> FloatArray:
        """Root of the mean squared residual [N·m], (n,)."""
        return np.asarray(np.sqrt(np.mean(self.residual**2, axis=0)))

    @property
    def nrmse(self) -> FloatArray:
        """RMSE over the standard deviation of the measured torque, (n,); not a number where that is constant."""
        spread = self.measured.std(axis=0)
        return np.asarray(np.divide(self.rmse, spread, out=np.full(len(spread), np.nan), where=spread > 0.0))

    @property
    def r2(self) -> FloatArray:
        """Coefficient of determination 1 − Σ residual² / Σ (measured − mean)², (n,)."""
        return 1.0 - self.nrmse**2

    def to_json(self) -> dict[str, Any]:
        """Turn the figures of a validation into what JSON can hold.

        Returns:
            Source, number of samples, joints and their RMSE [N·m], NRMSE and R², and findings; the same of each
            recording where there are several.
        """
        parts = {"recordings": [part.to_json() for part in self.parts]} if self.parts else {}
        return {
            "source": self.source,
            "samples": len(self.time),
            "joint_names": list(self.joint_names),
            "rmse": self.rmse.tolist(),
            "nrmse": _numbers(self.nrmse),
            "r2": _numbers(self.r2),
            "findings": findings_to_json(self.findings),
            **parts,
        }

    def __repr__(self) -> str:
        """Name the joints and their NRMSE."""
        errors = ", ".join(f"{n} {e:.3f}" for n, e in zip(self.joint_names, self.nrmse, strict=True))
        return f"Validation(nrmse: {errors})"

    def __str__(self) -> str:
        """Print as a table."""
        return to_text(*self._report())

    def _repr_html_(self) -> str:
        """Table for notebooks."""
        return to_html(*self._report())

    def _report(self) -> list[DataTable | str]:
        """Title, tables and number of samples."""
        samples = f"{len(self.time)} samples, both torques filtered alike"
        tables: list[DataTable | str] = [make_table(HEADERS, self.rows())]
        if self.parts:
            of_parts = [(part.source, *row) for part in self.parts for row in part.rows()]
            tables += ["each recording:", make_table(("recording", *HEADERS), of_parts)]
        return [f"Prediction of {self.source}", *tables, samples, *finding_lines(self.findings)]

    def rows(self) -> list[tuple[str, ...]]:
        """Write joint, RMSE, NRMSE and R² as rows of a table.

        Returns:
            One row a joint.
        """
        columns = (self.joint_names, self.rmse, self.nrmse, self.r2)
        return [(name, f"{e:.4g}", f"{n:.4f}", f"{r:.4f}") for name, e, n, r in zip(*columns, strict=True)]


def _numbers(array: FloatArray) -> list[float | None]:
    """List numbers; JSON knows no NaN, so that becomes null."""
    return [value if np.isfinite(value) else None for value in array.tolist()]


def validate(
    estimate: EstimateData, recordings: Recording | Iterable[Recording], *, preparation: Preparation | None = None
) -> Validation:
    """Predict the torque of one or several recordings and compare.

    Args:
        estimate: The estimate.
        recordings: Motions with torques, better none that the estimate was fitted to.
        preparation: Filter of both torques; None for the estimate's own.

    Returns:
        Measured and predicted torque with RMSE, NRMSE and R² of each joint, over all recordings and of each.

    Raises:
        ExoidError: There is no recording, or one lacks a joint or the torque or is too short for the filter.

    Example:
        >>> data = exoid.datasets.bleex_swing()
        >>> validation = exoid.validate(exoid.identify(data.leg, data.train), data.test)
        >>> bool((validation.nrmse < 0.07).all())
        True
    """
    several = [recordings] if isinstance(recordings, Recording) else list(recordings)
    wrong = [item for item in several if not isinstance(item, Recording)]
    if wrong or not several:
        what = f"{wrong[0]!r} is no recording" if wrong else "no recordings"
        raise ExoidError(what, remedy='pass at least one, such as Recording.from_csv("log.csv")')
    parts = tuple(_validate_one(estimate, each, preparation or estimate.preparation) for each in several)
    if len(parts) == 1:
        return parts[0]
    time, measured, predicted = (
        np.concatenate([getattr(part, name) for part in parts]) for name in ("time", "measured", "predicted")
    )
    source = ", ".join(part.source for part in parts)
    findings = tuple(finding for part in parts for finding in part.findings)
    return Validation(estimate.joint_names, time, measured, predicted, source, parts, findings)


def _validate_one(estimate: EstimateData, recording: Recording, preparation: Preparation) -> Validation:
    """Predict the torque of one recording, block by block."""
    prepared = prepare(estimate.model, recording, preparation, every=True)
    rows = (form_rows(estimate.model, prepared, stretch) for stretch in prepared.stretches())
    parts = [(of_some.time, of_some.tau, of_some.W @ estimate.values) for of_some in rows]
    time, measured, predicted = (np.concatenate(part) for part in zip(*parts, strict=True))
    source = recording.source.name if recording.source else "array"
    alone = Validation(estimate.joint_names, time, measured, predicted, source)
    used = slice(prepared.rows.start, prepared.rows.stop)
    ranges = MotionRanges.of(prepared.motion.q[used], prepared.motion.v[used], prepared.motion.a[used])
    name = recording.source.name if recording.source else ""
    found = (*extrapolations(estimate, ranges, name), *poor_predictions(estimate, alone.nrmse, name))
    return replace(alone, findings=ordered(found))
