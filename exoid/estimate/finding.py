"""Findings: faults of a log or a model, with their size, what they mean and what to do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from exoid.errors import BadArgumentError
from exoid.tools.tables import DataTable, make_table

Severity = Literal["info", "warning", "error"]

SEVERITIES: tuple[Severity, ...] = ("error", "warning", "info")
"""Severities, the worst first."""

Verdict = Literal["predicts", "predicts poorly", "does not predict"]

LOWERING = ("large-residual", "narrow-band", "wide-band", "torque-delay")
"""Findings that lower the verdict on a prediction."""

HEADERS = ("finding", "joint", "value", "95 % from", "to", "unit", "severity")
"""Columns of :func:`findings_table`."""


@dataclass(frozen=True)
class Finding:
    """One fault that a check found; prints itself.

    Attributes:
        kind: Kind of fault, such as "torque-delay"; ``docs/checks.md`` lists all kinds.
        joint: Joint whose channel has the fault; "" where it concerns all joints.
        value: Size of the fault, in :attr:`unit`.
        unit: Unit of the value.
        severity: "error" (do not use the result), "warning" (named parameters are doubtful) or "info".
        message: Meaning, one or two sentences.
        remedy: Advice on what to do.
        interval: 95 % interval of the value; None where there is none.
        parameters: Names of the parameters that the fault makes doubtful.
        recording: Name of the recording; "" where it concerns all recordings.
    """

    kind: str
    joint: str
    value: float
    unit: str
    severity: Severity
    message: str
    remedy: str
    interval: tuple[float, float] | None = None
    parameters: tuple[str, ...] = ()
    recording: str = ""

    def __post_init__(self) -> None:
        """Check that numbers are finite and the severity exists."""
        numbers = (self.value, *(self.interval or ()))
        if self.severity not in SEVERITIES or not np.isfinite(numbers).all():
            what = f"finding {self.kind} with severity {self.severity!r} and numbers {numbers}"
            raise BadArgumentError(what, remedy="identify again")

    def __str__(self) -> str:
        """Print in one line."""
        where = f" at {self.joint}" if self.joint else ""
        source = f" in {self.recording}" if self.recording else ""
        return f"{self.severity}: {self.kind}{where}{source}: {self.message}; {self.remedy}"


def ordered(findings: Sequence[Finding]) -> tuple[Finding, ...]:
    """Sort findings, the worst first; findings of one severity stay in order."""
    return tuple(sorted(findings, key=lambda finding: SEVERITIES.index(finding.severity)))


def findings_table(findings: Sequence[Finding]) -> DataTable:
    """Make a table of findings."""
    rows = []
    for finding in findings:
        low, high = ("", "") if finding.interval is None else (f"{end:.4g}" for end in finding.interval)
        value = f"{finding.value:.4g}"
        rows.append((finding.kind, finding.joint or "all", value, low, high, finding.unit, finding.severity))
    return make_table(HEADERS, rows)


def verdict_of(findings: Sequence[Finding]) -> Verdict:
    """Judge a prediction by its findings."""
    # An error (NRMSE above 1: a constant torque would predict better) means "does not predict". A warning that the
    # residual is large, the band too narrow, or the torque late means "predicts poorly". Information, such as a delay
    # that was corrected, lowers no verdict; nor does an extrapolation, as the torque was measured and predicted there.
    severities = {finding.severity for finding in findings if finding.kind in LOWERING}
    return "does not predict" if "error" in severities else "predicts poorly" if "warning" in severities else "predicts"


def verdict_line(findings: Sequence[Finding]) -> str:
    """Write the verdict and its reasons in one line."""
    reasons = []
    for kind in (*LOWERING, "extrapolation"):
        told = (one for one in findings if one.kind == kind and (one.severity != "info" or kind not in LOWERING))
        joints = dict.fromkeys(one.joint for one in told)
        if joints:
            reasons.append(f"{kind} at {', '.join(joints)}")
    return f"verdict: {verdict_of(findings)}" + (f" ({'; '.join(reasons)})" if reasons else "")
