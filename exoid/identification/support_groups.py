"""From recordings with contacts to groups of rows, one for each set of links that rest on the ground."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from exoid._typing import FloatArray
from exoid.actuators.constants import unknown_constants
from exoid.errors import NotSupportedError, UnreadableInputError
from exoid.estimate.finding import Finding, Severity
from exoid.leg.leg import Leg
from exoid.leg.reduction.planar import GRAVITY
from exoid.signals import Preparation, Recording, choose_preparation
from exoid.torques.contacts import Split, refuse_dead_switches, refuse_rolling_feet, split
from exoid.torques.contacts.imu import ROCKS, misread
from exoid.torques.contacts.stretches import EDGE
from exoid.torques.contacts.support_model import SupportModel

from .estimators import Estimator
from .findings.checkup import signal_findings
from .group_rows import Group
from .problem import Problem

MUCH_LEFT_OUT = 0.2  # more than this part of the samples left out is worth a warning
MEASURED = "measured"  # name of the samples at which no wrench is unknown


def support_groups(problem: Problem, estimator: Estimator, *, by_noise: bool, check: bool) -> Problem:
    """Split the recordings of each group by the links that rest on the ground with an unknown wrench."""
    if getattr(estimator, "fits_samples", False):
        raise NotSupportedError("this estimator simulates the leg without ground", remedy="use wls, huber or ols")
    if any(term.loaded for term in problem.terms):
        raise NotSupportedError("terms beside a ground are linear in their parameters", remedy="leave LoadFriction out")
    groups = [part for group in problem.groups for part in _split(group, by_noise=by_noise, check=check)]
    return replace(problem, groups=tuple(replace(group, memory_share=1.0 / len(groups)) for group in groups))


def _split(group: Group, *, by_noise: bool, check: bool) -> list[Group]:
    """Make a group of the recordings of each set of links, the first of which has the findings of all."""
    model = group.model
    if group.actuators is not None and unknown_constants(group.actuators):
        raise NotSupportedError("constants of drives are identified without contacts", remedy="give the constants")
    found: dict[tuple[tuple[str, ...], bool], list[Recording]] = {}
    findings = [*group.findings, *(signal_findings(model, group.data) if check else ())]
    data = [model.select(one) for one in group.motions]
    if len(data) < len(group.data):
        raise NotSupportedError("poses have no contacts", remedy="record motions, or use a leg on a fixed base")
    if group.preparation is None or any(group.preparation.parallel(one.sample_rate) is None for one in data):
        raise NotSupportedError("rows with contacts need the parallel filter", remedy="leave preparation out")
    most = max((float(np.nanmax(np.abs(one.tau), initial=0.0)) for one in data if one.tau is not None), default=0.0)
    if most > 1e4:  # a sole that gives way under it would turn the base over
        what = f"a torque of {most:.6g} N·m (limit 10000 N·m on the ground) looks like N·mm"
        remedy = "give the unit of its column, tau_<joint>=HEADER:N·mm, or divide by 1000"
        raise UnreadableInputError(what, where=data[0].file_name, remedy=remedy)
    refuse_dead_switches(model.leg, data)
    refuse_rolling_feet(model.leg, data)
    # The low-pass of each set of links is chosen below; before, one by all recordings says what it will smear
    smears = choose_preparation(data) if by_noise else group.preparation
    every, of_session = _split_session(model.leg, data, smears)
    findings += of_session
    for one, parts in zip(data, every, strict=True):
        findings += _left_out(parts, one)
        for part in parts.stretches:
            # on plates, rows that need no plate come first: what plates add has their noise, and a cut-off of its own
            for plates in (False, True) if part.plates else (False,):
                found.setdefault((part.links or part.plates, plates), []).append(part.recording)
    groups: list[Group] = []
    for (links, plates), data in found.items():
        q = np.vstack([one.q[one.mask] for one in data])
        support = SupportModel.of(model, links, q[:: 1 + len(q) // 2000], plates=plates)
        measured = np.logical_or.reduce([one.measured for one in data])
        if support.axes is not None and not measured.all():
            missing = [name for name, there in zip(model.leg.joint_names, measured, strict=True) if not there]
            what = f"the torque of {', '.join(missing)} is missing, and rows of {' and '.join(links)} need all"
            remedy = f"record it, or say that no actuator is there: passive=({', '.join(map(repr, missing))},)"
            raise UnreadableInputError(what, where=data[0].file_name, remedy=remedy, joints=tuple(missing))
        prepared = choose_preparation(data, base_rows=plates or not links) if by_noise else group.preparation
        name = " and ".join(links) + (" on plates" if plates else "") or MEASURED
        told = () if groups else tuple(findings)
        groups.append(replace(group, model=support, data=tuple(data), preparation=prepared, links=name, findings=told))
    return groups


def _split_session(leg: Leg, data: Sequence[Recording], preparation: Preparation) -> tuple[list[Split], list[Finding]]:
    """Split recordings that have one sensor on the base, and say what is wrong with it."""
    every = [split(leg, one, preparation) for one in data]
    findings = list(_places(data, every))
    # A recording in which no foot rests, as in a swing, has the bias of that one of the session which knows it best
    known = [parts.imu for parts in every if parts.imu is not None and not parts.imu.rocks]
    apart = float(np.std([errors.force_bias for errors in known], axis=0).max()) if known else 0.0
    if apart > ROCKS:
        findings.append(rocking_finding(apart / GRAVITY, "they tell no bias of the base's sensor"))
        return [split(leg, one, preparation, tell=False) for one in data], findings
    best = min(known, key=lambda errors: float(np.linalg.norm(errors.std[3:])), default=None)
    for k, one in enumerate(data):
        told = one.base is None or any(every[k].imu is errors for errors in known)
        every[k] = every[k] if told or best is None else split(leg, one, preparation, best)
    return every, findings


def _left_out(parts: Split, recording: Recording) -> Iterator[Finding]:
    """Say what feet tell of switches and of the base's sensor, how many samples were left out, and why."""
    left, name = parts.left, recording.file_name
    for foot, x in parts.late.items():
        remedy = "lower the threshold of the switches, or correct their time stamps"
        text = f"the switches of {foot} close {1e3 * x:.0f} ms after its touch-downs, with which contacts begin now"
        yield Finding("contact-kind", "", x, "s", "warning", text, remedy, recording=name)
    if delay := parts.delay:
        when = f"{abs(1e3 * delay):.0f} ms {'later' if delay > 0.0 else 'earlier'} than the angles"
        text = f"feet tell that the base's sensor reads {when}; it was moved"
        yield Finding("imu-delay", "", delay, "s", "warning", text, "stamp both with one clock", recording=name)
    if parts.imu is not None and parts.imu.rocks:
        yield rocking_finding(parts.imu.rocks, "they tell no bias of the base's sensor", name)
    unseen = f", and slips of all feet alike below {1e3 * parts.visible:.0f} mm/s are not seen" if parts.visible else ""
    slips = "say that a link rests which moves; they were left out"
    check_ground = "check contacts, the ground, and whether joints' zeros are right"
    rolls = "say that a link rests which rolls or slips; they count, as the motion of the base was measured" + unseen
    gaps = f"are in gaps of a contact that are shorter than {EDGE:g} s; they were filled"
    near = f"are within {parts.near:.2g} s of a touch-down; they were left out"
    stretched = "leave no row: knees are straight, or too many links rest for the joints"
    lifted = "have no foot flat on the ground, and the motion of the base was not measured; they were left out"
    rows = (  # share, from which on it is a warning, kind, what is so, and advice
        (left.slipping, MUCH_LEFT_OUT, "slipping-contact", slips, check_ground),
        (left.moving, 1.0, "slipping-contact", rolls, "nothing to do; without that measurement they would be left out"),
        (left.gaps, 1.0, "wrong-contact", gaps, "check the foot switch"),
        (left.changing, 1.0, "contact-changes", near, "nothing to do"),
        (left.singular, MUCH_LEFT_OUT, "singular-stance", stretched, "bend the knees, or measure the wrenches"),
        (left.floating, MUCH_LEFT_OUT, "singular-stance", lifted, "record an IMU on the torso"),
    )
    for share, many, kind, text, remedy in (row for row in rows if row[0] > 0.0):
        severity: Severity = "warning" if share > many else "info"
        what = f"{share:.1%} of the samples {text}"
        yield Finding(kind, "", share, "1", severity, what, remedy, recording=name)


def _places(data: Sequence[Recording], every: Sequence[Split]) -> Iterator[Finding]:
    """Say where the base's sensor is, if all recordings with it at one place tell that it is not where they say."""
    turns = defaultdict[tuple[float, ...], FloatArray](lambda: np.zeros((6, 6)))
    for one, parts in zip(data, every, strict=True):
        if one.base is not None:
            turns[tuple(one.base.position.tolist())] += parts.turns
    for position, total in turns.items():
        aside, scale = misread(total)
        if size := float(np.linalg.norm(aside)):
            place = ", ".join(f"{x:.2f}" for x in position + aside)
            text = f"turns of the base on feet tell that its sensor is {1e3 * size:.0f} mm from where the log says"
            advice = f"say that it is at ({place}) m of the root link: BaseMotion.from_imu(position=), --base-position"
            # 5 cm move the mass of a machine by percents
            yield Finding("imu-position", "", size, "m", "error" if size > 0.05 else "warning", text, advice)
        if scale != 1.0:
            text = f"the accelerometer of the base reads {scale:.3g} times what feet that rest tell"
            yield Finding("imu-scale", "", scale, "1", "error", text, "calibrate it, or divide its readings by that")


def rocking_finding(angle: float, then: str, name: str = "", parameters: tuple[str, ...] = ()) -> Finding:
    """Say that a foot that counts as flat rocks."""
    text = f"feet that are said to stand flat rock by {1e3 * angle:.2g} mrad (standard deviation): {then}"
    remedy = "check soles, contacts, zeros and play of joints; stand on flat soles, or say that feet stand on an edge"
    return Finding("rocking-foot", "", angle, "rad", "warning", text, remedy, None, parameters, name)
