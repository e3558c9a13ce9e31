"""Summaries of recordings before rows are formed: for refusals, and for the choice of the preparation."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import NotIdentifiableError
from exoid.estimate.data import Input
from exoid.signals import Poses, Recording
from exoid.signals.contacts import stands
from exoid.signals.cutoff import AccelerationPower, acceleration_power
from exoid.torques import TorqueModel
from exoid.torques.position_units import position_units

SMALLEST_MOTION = 2e-3  # a joint whose angle spans less [rad], about a tenth of a degree, counts as standing still


class Torques(NamedTuple):
    """Values that the torque of each joint has, (n,) each."""

    middle: FloatArray  # their median [N·m]
    share: FloatArray  # part of the samples that have exactly the median
    measured: NDArray[np.bool_]  # whether there are any, or the joint is passive
    passive: NDArray[np.bool_]  # whether the joint is passive
    computed: NDArray[np.bool_]  # whether they were computed of what a drive measured


class RecordingSummary(NamedTuple):
    """Evidence, range and torques of a recording."""

    evidence: Input  # name, hash and size
    source: str  # name of its file, for errors; "" for one made in memory
    lowest: FloatArray  # smallest angle of each joint of the leg [rad], (n,)
    highest: FloatArray  # largest angle of each joint [rad], (n,)
    mean: FloatArray  # mean angle of each joint [rad], (n,)
    torques: Torques | None  # none where there are none
    acceleration_power: AccelerationPower | None  # of the angles and their noise, for the cut-off; None if not needed
    # RMS angular velocity of the base, of a planar leg in its plane, over that of the first joint; 0 at rest
    base_turning: float = 0.0
    stands: bool = False  # whether rows depend on contacts, see `signals.contacts.stands`
    pulled: bool = False  # whether a wrench was measured that is not zero throughout


def summarize(model: TorqueModel, data: Recording | Poses, *, for_cutoff: bool = True) -> RecordingSummary:
    """Summarize a recording in one pass."""
    chosen = model.select(data)
    mask = chosen.mask if isinstance(chosen, Recording) else None
    counted = slice(None) if mask is None else mask
    if mask is not None and not mask.any():
        what = "no sample counts: the mask is 0 everywhere"
        raise NotIdentifiableError(what, where=data.file_name, remedy="leave the recording out")
    q = np.ascontiguousarray(chosen.q[counted].T)  # joint by joint is eight times as fast
    torques = None
    if chosen.tau is not None:
        tau = chosen.tau[counted]
        middle = np.median(tau[:: 1 + len(tau) // 100_000], axis=0)  # of samples spread over a long recording
        passive, computed = (np.isin(chosen.joint_names, getattr(chosen, name, ())) for name in ("passive", "computed"))
        share = np.array([np.count_nonzero(x == common) / len(tau) for x, common in zip(tau.T, middle, strict=True)])
        torques = Torques(middle, share, ~np.isnan(tau[0]), passive, computed)
    angles, power = (q.min(axis=1), q.max(axis=1), q.mean(axis=1)), acceleration_power(chosen) if for_cutoff else None
    turning = 0.0
    if isinstance(chosen, Recording) and chosen.base is not None:
        # rates of base and first joint, without their means; that of an unmoved joint counts as tiny
        omega = chosen.base.angular_velocity
        omega = omega @ model.leg.plane.lateral[:, np.newaxis] if model.leg.limbs else omega
        velocity = max(float(np.std(np.gradient(chosen.q[:, 0], chosen.time))), np.finfo(float).tiny)
        turning = float(np.sqrt(np.sum(np.var(omega, axis=0)))) / velocity
    wrenches = chosen.wrenches.values() if isinstance(chosen, Recording) else ()
    stood, pulled = stands(model.leg, chosen), any(one.force.any() or one.moment.any() for one in wrenches)
    return RecordingSummary(evidence(data), data.file_name, *angles, torques, power, turning, stood, pulled)


def refuse_still_joints(model: TorqueModel, summaries: Sequence[RecordingSummary], known: Sequence[str] = ()) -> None:
    """Refuse recordings in which a joint of the leg never moves, unless all of it is known beside them."""
    spans, means = angle_spans(summaries), np.mean([one.mean for one in summaries], axis=0)
    names, units = model.leg.joint_names, position_units(model.leg)
    for joint, (name, span, mean) in enumerate(zip(names, spans, means, strict=True)):
        if span >= SMALLEST_MOTION:
            continue
        own = model.own_parameters(joint)
        if not (own and set(own) <= set(known)):
            others = tuple(other for other in names if other != name)
            moved = f"{span:.2g} {units[joint].rad}"
            what = f"joint {name} stands still: it moves by {moved}, so nothing of it can be identified"
            remedy = f"move it, or lock it: Leg.from_urdf(..., joints={others}, locked={{{name!r}: {mean:.4g}}})"
            raise NotIdentifiableError(what, where=_sources(summaries), remedy=remedy, joints=(name,))


def refuse_dead_torques(model: TorqueModel, summaries: Sequence[RecordingSummary]) -> None:
    """Refuse torques of a joint that hardly ever change: a channel that was not connected."""
    # A recording in which a joint swings freely throughout, beside others, is none.
    measured = [(one, one.torques) for one in summaries if one.torques is not None]
    if not measured:
        return  # preparing them says so, and which column is missing
    every = [torques for _, torques in measured]
    driven = np.array([torques.measured & ~torques.passive for torques in every])
    if not driven.any():
        if any(one.pulled for one in summaries):
            return  # what moves the leg is known in N and N·m
        what = "no joint has a measured torque: without one, only ratios of parameters could be found"
        remedy = "record the torque of a joint that is not passive, or the wrench that moves the leg"
        raise NotIdentifiableError(what, where=_sources(summaries), remedy=remedy)
    values = np.array([torques.middle for torques in every])
    first = values[driven.argmax(axis=0), np.arange(len(values[0]))]
    same = np.array([torques.share == 1.0 for torques in every]) & (values == first)
    constant = (same | ~driven).all(axis=0) & driven.any(axis=0)
    names, units = model.leg.joint_names, position_units(model.leg)
    each = zip(names, first, constant, units, strict=True)
    dead = {joint: f"{value + 0.0:.6g} {unit.torque}" for joint, value, is_dead, unit in each if is_dead}
    if dead:
        found = "; ".join(f"the torque of joint {joint} is {value} in every sample" for joint, value in dead.items())
        mend = f"connect its torque channel, or map the right column to {', '.join(f'tau_{joint}' for joint in dead)}"
        what, joints = f"{found} although the joint{'s move' if len(dead) > 1 else ' moves'}", tuple(dead)
        remedy = f"{mend}; without an actuator it is passive={joints!r}, without a sensor unmeasured={joints!r}"
        listed = ",".join(dead)
        command = f"{mend}; give --passive {listed} without an actuator, --unmeasured {listed} without a sensor"
        raise NotIdentifiableError(what, where=_sources(summaries), remedy=remedy, command=command, joints=joints)
    for index, joint in enumerate(names):
        for one, torques in measured:
            middle, share = torques.middle[index], torques.share[index]
            if 0.5 < share < 1.0 and not torques.passive[index]:  # the rest was not measured
                value = f"{middle + 0.0:.6g} {units[index].torque}"
                what = f"the torque of joint {joint} is {value} in {share:.0%} of samples, and it moves"
                remedy = "use the part of the recording in which torque was measured, see Recording.between"
                raise NotIdentifiableError(what, where=one.source, remedy=remedy, joints=(joint,))


def unmeasured_joints(joint_names: Sequence[str], summaries: Sequence[RecordingSummary]) -> tuple[str, ...]:
    """List the joints whose torque is not known in any recording, although that of others is."""
    measured = [one.torques.measured for one in summaries if one.torques is not None]
    if not measured:
        return ()
    return tuple(name for name, there in zip(joint_names, np.any(measured, axis=0), strict=True) if not there)


def angle_spans(summaries: Sequence[RecordingSummary]) -> FloatArray:
    """Span of the angle of each joint over all recordings [rad], (n,)."""
    return np.asarray(np.max([one.highest for one in summaries], 0) - np.min([one.lowest for one in summaries], 0))


def evidence(data: Recording | Poses) -> Input:
    """Describe a recording by its name, hash and size."""
    rate, segments = (data.sample_rate, data.segment_times) if isinstance(data, Recording) else (0.0, ())
    payloads = tuple(map(str, data.payloads))
    base, wrenches, passive = (getattr(data, name, None) for name in ("base", "wrenches", "passive"))
    about = (len(data), rate, segments, payloads, base is not None, tuple(wrenches or ()), passive or ())
    if data.source is not None:
        return Input(data.source.name, data.source.sha256, *about)
    named = ("time", "q", "v", "a", "tau", "current", "force", "motor_torque", "motor_angle")
    arrays = [getattr(data, name, None) for name in named] + ([] if base is None else [base.columns, base.position])
    arrays += [part for one in (wrenches or {}).values() for part in (one.columns, one.point)]
    arrays += [*getattr(data, "contacts", {}).values(), *({} if data.torso is None else vars(data.torso)).values()]
    digest = hashlib.sha256()
    for array in arrays:
        if array is not None:
            digest.update(np.ascontiguousarray(array).data)
    return Input("array", digest.hexdigest(), *about)


def _sources(summaries: Sequence[RecordingSummary]) -> str:
    return ", ".join(one.source for one in summaries if one.source)
