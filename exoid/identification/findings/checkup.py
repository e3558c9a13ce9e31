"""All checks of a log and of the fit to it, in the order in which they make sense."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate.evidence import MotionRanges
from exoid.estimate.finding import Finding, ordered
from exoid.estimate.late_velocity import late_velocities
from exoid.regression.least_squares import TINY
from exoid.regression.row_data import Rows
from exoid.signals import Poses, Recording
from exoid.torques import TorqueModel
from exoid.torques.catalog import turning_joints

from .base_motion import gravity_size, out_of_plane_base
from .channels import channel_findings
from .efforts import POOR, missing_gravity, unsigned_torques
from .evidence import Evidence, torque_shares
from .physics import CheckedFit, impossible_leg, large_residuals, torque_scale, turned_segment
from .readings import gross_findings
from .repeats import repeated_data
from .sample import FittedLeg, few_of, gather
from .score import State, in_half_widths
from .search import DOUBTFUL_MOVE, find_faults, findings_of
from .timing import angle_jumps, loop_gaps, missing_samples, stamp_jitter, wraps

OF_TORQUE = "torque", "unmodelled", "cross-talk", "large-residual"  # how kinds of findings of a torque begin


class Checkup(NamedTuple):
    """Result of all checks."""

    findings: tuple[Finding, ...] = ()  # the worst first
    ranges: MotionRanges | None = None  # ranges of the motion; None where no rows could be formed
    # standard deviation of the torque of each joint [N·m], (n,); None without rows with the preparation of the fit
    torque_spread: FloatArray | None = None
    moving: Sequence[Rows] = ()  # rows of recordings, the last columns of which are friction of other forms


def check_fit(fitted: FittedLeg) -> Checkup:
    """Check a log and the fit to it."""
    # Faults of channels come first. Where one of them is an error, or a gross fault is found, finer checks would only
    # describe its consequences, and are left out.
    fitted = fitted._replace(data=few_of(fitted.data))
    found = list(signal_findings(fitted.model, fitted.data))
    sample = fitted.sampled()
    try:
        evidence = gather(sample, friction=True)
    except ExoidError:
        return Checkup(ordered(found))
    found += [*out_of_plane_base(sample), *gravity_size(sample)]
    broken = any(one.severity == "error" for one in found)
    sample, evidence, contradicted = (sample, evidence, []) if broken else _contradicted(sample, evidence)
    checked = CheckedFit.of(sample, evidence)
    found += _fit_findings(checked, broken=broken)
    found += [] if any(one.severity == "error" for one in found) else contradicted  # an error may be why
    spread = checked.spread if sample.preparation is fitted.preparation else None
    moving = [part for part, rest in zip(evidence.parts, evidence.at_rest, strict=True) if not rest]
    computed = {joint for one in sample.data if isinstance(one, Recording) for joint in one.computed}
    more = "; its torque was computed: check ratio, constants and attachment points of its drive, and their signs"
    found = [replace(x, remedy=x.remedy + more * (x.joint in computed and x.kind.startswith(OF_TORQUE))) for x in found]
    return Checkup(ordered(found), evidence.ranges, spread, moving)


def signal_findings(model: TorqueModel, data: Sequence[Recording | Poses]) -> Iterator[Finding]:
    """Check the channels and times of recordings; no fit is needed."""
    recordings, closure = [one for one in data if isinstance(one, Recording)], model.leg.closure
    turns = turning_joints(model.leg)
    for one in recordings:
        chosen = model.select(one)
        found: dict[tuple[str, str], Finding] = {}
        checks = channel_findings, wraps, angle_jumps, missing_samples, stamp_jitter, late_velocities
        count = len(one) // 10_000 if len(one) > 100_000 else 1  # what lasts for seconds would not show in minutes
        ends = np.linspace(0, len(one), count + 1).astype(int).tolist()
        parts = (chosen.slice(start, stop + 100) for start, stop in pairwise(ends))  # a jump may be where they join
        every = (there for part in parts for look in checks for there in look(part))
        for finding in (*every, *(loop_gaps(closure, one) if closure is not None else ())):
            key = (finding.kind, finding.joint)
            if key not in found or abs(finding.value) > abs(found[key].value):
                found[key] = finding
        for (kind, joint), finding in found.items():
            joints, text = list(range(len(model.acting))), finding.message
            if joint and not kind.startswith("velocity") and "angle" not in text:  # both couple the joints
                joints = [chosen.joint_names.index(joint)]
            slides = finding.unit == "rad" and joint and not turns[chosen.joint_names.index(joint)]
            unit, text = ("m", text.replace(" mrad", " mm")) if slides else (finding.unit, text)
            doubtful = np.array(model.names)[model.acting[joints].any(axis=0)].tolist()
            where = one.file_name if len(data) > 1 else ""
            yield replace(finding, parameters=tuple(doubtful), recording=where, unit=unit, message=text)
    if len(recordings) > 1:
        yield from repeated_data([model.select(one) for one in recordings], model.names)


def _contradicted(fitted: FittedLeg, evidence: Evidence) -> tuple[FittedLeg, Evidence, list[Finding]]:
    """Find values told beside the log that it contradicts, the worst first, and go on without them."""
    found, names = list[Finding](), fitted.model.names
    told = {names.index(name): x for name, x in fitted.told.items() if name in names}
    # friction of another form makes no body another one
    forms = "friction", "sharpness", "reversals"
    friction = [k for k, one in enumerate(fitted.library.columns) if one.kind.startswith(forms)]
    while told:
        # a grossly wrong value would hide in the residuals of a fit that keeps it
        alone = {k: State.of(evidence, (*friction, *fitted.library.free, k - len(names))).alone(k) for k in told}
        apart = {k: abs(x - told[k][0]) / np.hypot(std, max(told[k][1], TINY)) for k, (x, std) in alone.items()}
        k = max(told, key=lambda k: apart[k])
        (x, std), (value, _), unit = alone[k], told.pop(k), fitted.model.units[k]
        if apart[k] < 4.5:  # right values reach 2.8 standard deviations (clean logs, seeds to 12)
            break
        if torque_shares(evidence.factors, [k], np.array([[x - value]]))[0] < 3e-3:
            continue  # nor is the torque of any joint changed by 0.3 %
        what = f"{names[k]} is told to be {value:.4g}, and by the log alone is {x:.4g} ± {std:.2g} {unit}"
        # of two that say how large an unknown torque constant is, either may be wrong
        rivals = [names[one] for one in told if apart[one] > 0.7 * apart[k]]
        what += f"; another {' or '.join(rivals)} would explain this log about as well" if rivals else ""
        remedy = "leave it out of known= and prior=, or look for a scale, a zero or a load that makes the log say so"
        before, half, own = fitted.values, 2.0 * np.sqrt(np.diag(fitted.covariance)), np.arange(len(names)) == k
        fitted = fitted._replace(fixed=np.where(own, np.nan, fitted.fixed))
        evidence = gather(fitted, friction=True)
        fitted = fitted._replace(values=State.of(evidence, fitted.library.free).values)
        moved = own | np.isin(names, rivals) | (in_half_widths(fitted.values - before, half) > DOUBTFUL_MOVE)
        ends, doubtful = (x - 2.0 * std, x + 2.0 * std), tuple(np.array(names)[moved].tolist())
        found.append(Finding("contradicted-value", "", x, unit, "warning", what, remedy, ends, doubtful))
    return fitted, evidence, found


def _fit_findings(checked: CheckedFit, *, broken: bool) -> Iterator[Finding]:
    """Check the fit, unless a channel is broken."""
    found, loaded = list[Finding](), all(one.payloads for one in checked.fitted.data)
    explained, angles, left = False, True, np.zeros(len(checked.nrmse))  # left are residuals beside all that was found
    if not broken:
        found += [*unsigned_torques(checked)] or [*missing_gravity(checked)]
        # A payload that is stated too heavy leaves negative parameters, too. Readings of angles need all rows anew.
        angles = bool((checked.nrmse > POOR).any() or (checked.below.any() and not loaded))
        if not found and (angles or (checked.nrmse > 0.25 * POOR).any()):
            found += gross_findings(checked.fitted, checked.evidence, angles=angles)
        # a unit hides no other fault, but where it is that of one log
        units = [found.pop()] if found and found[0].kind == "torque-scale" and not found[0].recording else []
        scales = [] if found else list(torque_scale(checked))
        scales += [one for one in units if one.joint not in {other.joint for other in scales}]
        if not found:
            found, explained, left = _finer_findings(checked.fitted, checked.evidence, scales)
        found = found or scales
        zeros, kinds = {"angle-offset", "gravity-direction"}, {one.kind for one in found}
        if not (kinds & zeros or any(one.severity == "error" for one in found)):
            found += turned_segment(checked, 0.1 if "torque-delay" in kinds else 0.03)  # 20 ms turn BLEEX's by 3.3°
    if not explained and not any(finding.severity == "error" for finding in found):
        leg, library = checked.fitted.model.leg, checked.fitted.library
        # friction of another form makes no leg impossible
        beside = State.of(checked.evidence, (*library.always, *library.friction, *library.free))
        found += impossible_leg(leg, beside.values, beside.covariance, checked.evidence.factors)
    impossible = any(finding.kind == "impossible-leg" for finding in found)
    if not (angles or loaded) and (impossible or any(one.kind == "angle-scale" and one.value < 0.5 for one in found)):
        gross = gross_findings(checked.fitted, checked.evidence, angles=True)  # of a joint without torque, say
        found = [one for one in gross if one.kind == "angle-sign"] or found
    yield from (*found, *large_residuals(checked, left, impossible=impossible))


def _finer_findings(
    fitted: FittedLeg, evidence: Evidence, scales: Sequence[Finding]
) -> tuple[list[Finding], bool, FloatArray]:
    """Faults of nuisance columns, beside scales of torques; whether one moves parameters far; RMS residuals left."""
    model, factors = fitted.model, np.ones(len(fitted.model.leg.joint_names))
    for finding in (one for one in scales if one.joint and one.severity != "info"):
        factors[model.leg.joint_names.index(finding.joint)] = 1.0 / finding.value
    if (factors != 1.0).any():  # to the fit of all joints, another unit of one would look like other faults
        data = [one if one.tau is None else replace(one, tau=one.tau * factors) for one in fitted.data]
        fitted = fitted._replace(data=tuple(data))
        evidence = gather(fitted._replace(values=State.of(gather(fitted), ()).values))
    faults, left = find_faults(fitted, evidence)
    known = {(finding.kind, finding.joint) for finding in scales}
    if scales and len(model.leg.joint_names) == 2:  # of two joints only the ratio shows, at the second
        known.add(("torque-scale", model.leg.joint_names[1]))
    finer = [one for one in findings_of(fitted, faults) if (one.kind, one.joint) not in known]
    return [*scales, *finer], any(fault.moves_far for fault in faults), left / factors
