"""Summary of a recording before its rows are formed, and refusal of recordings that cannot be identified from."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate.data import Input
from exoid.regression.rows import for_leg, source_of
from exoid.signals import Poses, Recording
from exoid.signals.default_preparation import AccelerationPower, acceleration_power
from exoid.torques import TorqueModel

SMALLEST_MOTION = 2e-3
"""A joint whose angle spans less than this [rad], about a tenth of a degree, counts as standing still."""

MOST = 0.5
"""Torque that has one and the same value in more than this part of the samples was not measured."""

LOOKED_AT = 100_000
"""Samples spread over a long recording that are looked at to find that value."""


class Torques(NamedTuple):
    """Values that the torque of each joint has, (n,) each.

    Attributes:
        first: In the first sample [N·m].
        constant: Whether all others are the same.
        middle: Their median [N·m].
        share: Part of the samples that have exactly the median.
    """

    first: FloatArray
    constant: NDArray[np.bool_]
    middle: FloatArray
    share: FloatArray


class RecordingSummary(NamedTuple):
    """Evidence, range and torques of a recording.

    Attributes:
        evidence: Name, hash and size.
        source: Name of its file, for errors; "" for one made in memory.
        lowest: Smallest angle of each joint of the leg [rad], (n,).
        highest: Largest angle of each joint [rad], (n,).
        mean: Mean angle of each joint [rad], (n,).
        torques: None where there are none.
        acceleration_power: Noise of the angles beside their motion, for the cut-off; None where it is not needed.
    """

    evidence: Input
    source: str
    lowest: FloatArray
    highest: FloatArray
    mean: FloatArray
    torques: Torques | None
    acceleration_power: AccelerationPower | None


def summarize(model: TorqueModel, data: Recording | Poses, *, for_cutoff: bool = True) -> RecordingSummary:
    """Summarize a recording in one pass.

    Args:
        model: For its joints.
        data: The recording.
        for_cutoff: Whether to compare noise and motion, for :func:`exoid.signals.default_preparation.cutoff_from`.

    Returns:
        The summary.

    Raises:
        ExoidError: A joint is missing, time has a gap, or the mask leaves no sample.
    """
    chosen = for_leg(model, data)
    mask = chosen.mask if isinstance(chosen, Recording) else None
    counted = slice(None) if mask is None else mask
    if mask is not None and not mask.any():
        raise ExoidError(
            "no sample counts: the mask is 0 everywhere", where=source_of(data), remedy="leave the recording out"
        )
    q = np.ascontiguousarray(chosen.q[counted].T)  # joint by joint is eight times as fast
    tau = None if chosen.tau is None else chosen.tau[counted]
    return RecordingSummary(
        evidence(data),
        source_of(data),
        q.min(axis=1),
        q.max(axis=1),
        q.mean(axis=1),
        None if tau is None else _torques(tau),
        acceleration_power(chosen) if for_cutoff else None,
    )


def angles(summaries: Sequence[RecordingSummary]) -> tuple[FloatArray, FloatArray]:
    """Smallest and largest angle of each joint in all recordings [rad], (n,) each."""
    return np.min([one.lowest for one in summaries], axis=0), np.max([one.highest for one in summaries], axis=0)


def refuse_still_joints(model: TorqueModel, summaries: Sequence[RecordingSummary], known: Sequence[str] = ()) -> None:
    """Refuse recordings in which a joint of the leg never moves, unless all of it is known beside them.

    Args:
        model: Torque model, for its joints.
        summaries: Summaries of all recordings and poses.
        known: Parameters that are known or have a prior.

    Raises:
        ExoidError: Names the joint, how little it moves, and how to lock it.
    """
    lowest, highest = (np.array([getattr(one, side) for one in summaries]) for side in ("lowest", "highest"))
    spans, means = highest.max(axis=0) - lowest.min(axis=0), np.mean([one.mean for one in summaries], axis=0)
    names = model.leg.joint_names
    for joint, (name, span, mean) in enumerate(zip(names, spans, means, strict=True)):
        own = model.own_parameters(joint)
        if span < SMALLEST_MOTION and not (own and set(own) <= set(known)):
            others = tuple(other for other in names if other != name)
            raise ExoidError(
                f"joint {name} stands still: its angle spans {span:.2g} rad, so nothing of it can be identified",
                where=_sources(summaries),
                remedy=f"move it, or lock it: Leg.from_urdf(..., joints={others}, locked={{{name!r}: {mean:.4g}}})",
            )


def refuse_dead_torques(model: TorqueModel, summaries: Sequence[RecordingSummary]) -> None:
    """Refuse torques of a joint that never change, or stand still most of the time: a channel that was not connected.

    A recording in which a joint swings freely throughout, beside others, is none.

    Args:
        model: Torque model, for its joints.
        summaries: Summaries of all recordings of a group.

    Raises:
        ExoidError: Names the joint and the value.
    """
    measured = [(one, one.torques) for one in summaries if one.torques is not None]
    if not measured:
        return  # preparing them says so, and which column is missing
    for index, joint in enumerate(model.leg.joint_names):
        value = measured[0][1].first[index]
        if all(torques.constant[index] and torques.first[index] == value for _, torques in measured):
            raise ExoidError(
                f"the torque of joint {joint} is {value + 0.0:.6g} N·m in every sample although the joint moves",
                where=_sources(summaries),
                remedy="connect its torque channel, or map the right column to tau_" + joint,
            )
        for one, torques in measured:
            middle, share = torques.middle[index], torques.share[index]
            if MOST < share < 1.0:
                raise ExoidError(
                    f"the torque of joint {joint} is {middle + 0.0:.6g} N·m in {share:.0%} of the samples although "
                    "the joint moves: these say nothing, or something wrong",
                    where=one.source,
                    remedy="use the part of the recording in which torque was measured, see Recording.between",
                )


def _torques(tau: FloatArray) -> Torques:
    first = tau[0].copy()  # a view would keep all of it
    middle = np.median(tau[:: 1 + len(tau) // LOOKED_AT], axis=0)
    constant, share = [], []
    for of_joint, value, common in zip(tau.T, first, middle, strict=True):
        constant.append(bool((of_joint == value).all()))
        share.append(np.count_nonzero(of_joint == common) / len(tau))
    return Torques(first, np.array(constant), middle, np.array(share))


def evidence(data: Recording | Poses) -> Input:
    """Describe a recording by its name, hash and size."""
    rate, segments = (data.sample_rate, data.segment_times) if isinstance(data, Recording) else (0.0, ())
    if data.source is not None:
        return Input(data.source.name, data.source.sha256, len(data), rate, segments)
    digest = hashlib.sha256()
    for name in ("time", "q", "v", "a", "tau"):
        array = getattr(data, name, None)
        if array is not None:
            digest.update(np.ascontiguousarray(array).data)
    return Input("array", digest.hexdigest(), len(data), rate, segments)


def _sources(summaries: Sequence[RecordingSummary]) -> str:
    return ", ".join(one.source for one in summaries if one.source)
