"""Verdict of a validation: whether an estimate predicts a recording."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from .finding import Finding

Verdict = Literal["predicts", "predicts poorly", "does not predict"]

WORDS: tuple[Verdict, ...] = ("predicts", "predicts poorly", "does not predict")
"""Verdicts, the best first."""

LOWERING = ("large-residual", "narrow-band", "torque-delay")
"""Findings that lower the verdict; an extrapolation alone does not, as the torque was measured and predicted there."""


def verdict_of(findings: Sequence[Finding]) -> Verdict:
    """Judge a prediction by its findings."""
    # An error (NRMSE above 1: a constant torque would predict better) means "does not predict". A warning that the
    # residual is large, the band too narrow, or the torque late means "predicts poorly".
    lowering = _lowering(findings)
    if any(finding.severity == "error" for finding in lowering):
        return "does not predict"
    return "predicts poorly" if lowering else "predicts"


def verdict_line(findings: Sequence[Finding]) -> str:
    """Write the verdict and its reasons in one line."""
    reasons = []
    told = [*_lowering(findings), *(finding for finding in findings if finding.kind == "extrapolation")]
    for kind in (*LOWERING, "extrapolation"):
        joints = dict.fromkeys(finding.joint for finding in told if finding.kind == kind)
        if joints:
            reasons.append(f"{kind} at {', '.join(joints)}")
    return f"verdict: {verdict_of(findings)}" + (f" ({'; '.join(reasons)})" if reasons else "")


def _lowering(findings: Sequence[Finding]) -> list[Finding]:
    """Findings that lower the verdict; information, such as a delay that was corrected, does not."""
    return [finding for finding in findings if finding.kind in LOWERING and finding.severity != "info"]
