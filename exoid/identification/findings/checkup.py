"""All checks of a log and of the fit to it, in the order in which they make sense."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.actuators import Actuators
from exoid.errors import ExoidError
from exoid.estimate.finding import Finding, ordered
from exoid.estimate.motion_ranges import MotionRanges
from exoid.regression.row_data import Rows
from exoid.regression.rows import for_leg
from exoid.signals import FiniteDifference, MovingAverage, Poses, Preparation, Recording, ZeroPhase
from exoid.torques import TorqueModel

from .against_urdf import (
    far_from_urdf,
    impossible_leg,
    large_residuals,
    negative_friction,
    nrmse_of,
    persistence_of,
    torque_scale,
    torque_spread_of,
    turned_segment,
)
from .alternatives import POOR, gross_findings, negative_parameters
from .arm_columns import arm_columns
from .channels import channel_findings
from .evidence import Evidence
from .gravity_size import gravity_size_findings
from .model_checks import Delays, delays, find_faults
from .out_of_plane import out_of_plane_findings
from .repeats import repeated_data
from .sample import Checked, averaged, few_of, gather, names_of, segments, some_samples
from .sentences import findings_of
from .timing import timing_findings

LARGE_CROSS_TALK = 0.3
"""No torque sensor sees so large a part of other joints' torques: motors of a coupling do."""


class FittedLeg(NamedTuple):
    """A fit that is checked.

    Attributes:
        model: Torque model.
        preparation: Filter and differentiation.
        fixed: Known values of parameters, (P,); not a number where they are free.
        values: Fitted parameters, (P,).
        covariance: Their covariance, (P, P).
        actuators: Drives of the recordings; None where torques were measured.
    """

    model: TorqueModel
    preparation: Preparation
    fixed: FloatArray
    values: FloatArray
    covariance: FloatArray
    actuators: Actuators | None = None


class Checkup(NamedTuple):
    """Result of all checks.

    Attributes:
        findings: Findings, the worst first.
        ranges: Ranges of the motion; None where no rows could be formed.
        friction: Rows of parameters and friction of other forms, of each recording in motion; None where they were not
            formed with the preparation of the fit.
        torque_spread: Standard deviation of the torque of each joint [N·m], (n,); None likewise.
    """

    findings: tuple[Finding, ...] = ()
    ranges: MotionRanges | None = None
    friction: tuple[Rows, ...] | None = None
    torque_spread: FloatArray | None = None


def signal_findings(model: TorqueModel, data: Sequence[Recording | Poses]) -> tuple[Finding, ...]:
    """Check the channels and times of recordings; no fit is needed.

    Args:
        model: Torque model, for its joints.
        data: Recordings and poses.

    Returns:
        Findings.
    """
    return tuple(_signal_findings(model, data))


def check_fit(fitted: FittedLeg, data: Sequence[Recording | Poses]) -> Checkup:
    """Check a log and the fit to it.

    Faults of channels come first. Where one of them is an error, or a gross fault is found, finer checks would only
    describe its consequences, and are left out.

    Args:
        fitted: The fit.
        data: Recordings and poses.

    Returns:
        Findings, and ranges of the motion.
    """
    model, values, data = fitted.model, fitted.values, few_of(data)
    found = list(signal_findings(model, data))
    checked = _checked(fitted, data)
    try:
        evidence = gather(checked, values, other_friction=checked.preparation is fitted.preparation)
    except ExoidError:
        return Checkup(ordered(found))
    found += out_of_plane_findings(model, checked.preparation, checked.data)
    found += gravity_size_findings(model, checked.data)
    ranges = evidence.ranges[0]
    for other in evidence.ranges[1:]:
        ranges = ranges.joined(other)
    found += tuple(_fit_findings(fitted, checked, evidence, found))
    if checked.preparation is not fitted.preparation:
        return Checkup(ordered(found), ranges)
    return Checkup(ordered(found), ranges, tuple(evidence.friction), torque_spread_of(evidence))


def torque_delays(fitted: FittedLeg, data: Sequence[Recording | Poses]) -> Delays:
    """Estimate by how much the torque of each joint is late.

    Args:
        fitted: The fit.
        data: Recordings and poses.

    Returns:
        Significant delays, 0 elsewhere.
    """
    checked = _checked(fitted, few_of(data))
    return delays(find_faults(checked, fitted.values), len(fitted.model.joint_names))


def _checked(fitted: FittedLeg, data: Sequence[Recording | Poses]) -> Checked:
    """Take samples for a check; plain differences are noisier than the faults that are looked for, and are not used."""
    noisy = isinstance(fitted.preparation, (FiniteDifference, MovingAverage))
    preparation = ZeroPhase() if noisy else fitted.preparation
    sampled = some_samples(fitted.model, data)
    arms = {
        joint: arm
        for joint, arm in arm_columns(fitted.actuators, fitted.model.leg).items()
        if all(isinstance(one, Recording) and one.joint_names[joint] in one.computed for one in sampled)
    }
    averages = tuple(averaged(one, preparation) for one in sampled)
    return Checked(fitted.model, averages, preparation, fitted.fixed, arms)


def _signal_findings(model: TorqueModel, data: Sequence[Recording | Poses]) -> Iterator[Finding]:
    acting = {
        joint: tuple(name for name, acts in zip(model.names, model.acting[j], strict=True) if acts)
        for j, joint in enumerate(model.joint_names)
    }
    names = list(names_of(data))
    recordings = []
    for one, name in zip(data, names, strict=True):
        if isinstance(one, Poses):
            continue
        chosen = for_leg(model, one)
        acting_here = dict(zip(chosen.joint_names, acting.values(), strict=True))
        source = name if len(data) > 1 else ""
        found: dict[tuple[str, str], Finding] = {}
        for part in segments(chosen):
            for finding in (*channel_findings(part, acting_here, source), *timing_findings(part, acting_here, source)):
                key = (finding.kind, finding.joint)
                if key not in found or abs(finding.value) > abs(found[key].value):
                    found[key] = finding
        yield from found.values()
        recordings.append((chosen, name))
    yield from repeated_data([one for one, _ in recordings], [name for _, name in recordings], model.names)


def _fit_findings(
    fitted: FittedLeg, checked: Checked, evidence: Evidence, before: Sequence[Finding]
) -> Iterator[Finding]:
    """Check the fit, unless a channel is broken."""
    model, values = fitted.model, fitted.values
    std = np.sqrt(np.maximum(np.diag(fitted.covariance), 0.0))
    nrmse = nrmse_of(evidence, values)
    below = negative_parameters(model, values, std, evidence.torque_shares(np.arange(evidence.count), values))
    broken = any(finding.severity == "error" for finding in before)
    found: list[Finding] = []
    explained = False  # impossible parameters
    if not broken:
        if (nrmse > POOR).any() or below.any():
            found += gross_findings(checked)
        gross = bool(found)
        if not gross:
            found += torque_scale(model, evidence)
        if all(finding.joint for finding in found if finding.kind == "torque-scale") and not gross:
            faults = find_faults(checked, values, evidence)
            explained = any(size.moves_far for size in faults)
            finer = findings_of(model, faults)
            if any(finding.kind == "cross-talk" and finding.value > LARGE_CROSS_TALK for finding in finer):
                mixed = tuple(finding for finding in gross_findings(checked) if finding.kind == "coupled-joints")
                finer = mixed or finer
            found += [finding for finding in finer if finding.kind not in {one.kind for one in found}]
        if not found:
            found += far_from_urdf(model, values, std)
            found += turned_segment(model, values, std)
    yield from found
    if not explained and not any(finding.severity == "error" for finding in found):
        yield from impossible_leg(model, evidence, values, fitted.covariance)
        yield from negative_friction(model, values, below)
    doubted = broken or any(finding.severity != "info" for finding in found)
    persistence = None if doubted else persistence_of(evidence, values)
    yield from large_residuals(model, nrmse, persistence=persistence)
