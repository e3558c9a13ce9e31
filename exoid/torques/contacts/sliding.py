"""Links that are said to rest and move: against each other, or against an inertial measurement unit."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from functools import partial
from itertools import combinations, pairwise, product
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import BoolArray, FloatArray
from exoid.errors import UnreadableInputError
from exoid.leg.leg import Leg
from exoid.leg.link_frames import ball_radius, lowest_point
from exoid.signals import BaseMotion, Recording
from exoid.signals.cutoff import robust_std
from exoid.signals.filters.low_pass import slow_part
from exoid.signals.link_wrenches import link_placements

from .imu import ENDS, angle_mistakes
from .standing_base import StandingBase

SLIDING, TILTING = 0.03, 0.15
"""A link that is said to rest and moves faster than this [m/s, rad/s] slips, or its contact is wrong."""

LOOK = 8.0
"""Cut-off frequency of the velocities in which slipping is looked for [Hz]."""

BASELINE = 0.8
"""Window of the running median of the velocity [s]: slips shorter than half of it stand out, drift does not."""


class Slip(NamedTuple):
    """Samples at which a link that is said to rest slides, as an inertial measurement unit sees it."""

    slides: NDArray[np.bool_]  # whether a link slides, (N,)
    visible: float  # slowest slip that is seen [m/s]; zero where no rest is long enough to look for one


def slipping(
    leg: Leg, rest: Mapping[str, BoolArray], q: FloatArray, time: FloatArray, widened: int
) -> NDArray[np.bool_]:
    """Find the samples at which links that rest move: against each other where the base floats."""
    slips, v = np.zeros(len(q), dtype=np.bool_), np.gradient(q, time, axis=0)
    if not leg.base_rows:
        for link, flags in rest.items():
            twist = np.einsum("ncj,nj->nc", leg.frame_jacobian(q, link, lowest_point(leg, q, link)), v)
            turns = (np.linalg.norm(twist[:, 3:], axis=1) > TILTING) & (leg.contact_kind(link) == "flat")
            slips |= flags & (turns | (np.linalg.norm(twist[:, :3], axis=1) > SLIDING))
    levers, places = dict[str, FloatArray](), dict[str, FloatArray]()
    for link in rest if leg.base_rows else ():
        if leg.contact_kind(link) == "flat":
            levers[link] = motion_on(leg, link, q, time)
        elif not ball_radius(leg, link):  # distances of balls that roll change
            places[link] = link_placements(leg, q, link).translation
    for link, other in combinations(places, 2):  # however the base turns, two points that rest keep their distance
        change = np.gradient(np.linalg.norm(places[link] - places[other], axis=1), time)
        slips |= rest[link] & rest[other] & (np.abs(change) > SLIDING)
    for link, other in combinations(levers, 2):
        fast, turns = _apart(levers[link], levers[other])
        slips |= rest[link] & rest[other] & (fast | turns)
    return np.asarray(scipy.ndimage.binary_dilation(slips, iterations=max(1, widened))) if slips.any() else slips


def _apart(one: FloatArray, other: FloatArray) -> tuple[BoolArray, BoolArray]:
    """Tell where motions of a base on two feet differ by more than rest allows: in velocity, and in rate of turn."""
    speed, turn = np.split(one - other, [-(one.shape[1] // 2)], axis=1)  # one row of a planar base turns
    return np.linalg.norm(speed, axis=1) > SLIDING, np.linalg.norm(turn, axis=1) > TILTING


def motion_on(leg: Leg, link: str, q: FloatArray, time: FloatArray) -> FloatArray:
    """Velocity of a floating base on a flat link that rests, as its base rows count it: linear before angular."""
    base, jacobian = leg.base_rows, leg.contact_jacobian(q, link)
    of_joints = np.einsum("ncj,nj->nc", jacobian[..., base:], np.gradient(q, time, axis=0))
    return -np.linalg.solve(jacobian[..., :base], of_joints[..., np.newaxis])[..., 0]


def refuse_dead_switches(leg: Leg, data: Sequence[Recording]) -> None:
    """Refuse a flat foot whose switch is the same in all recordings, where its motion denies it."""
    read = defaultdict[str, set[bool]](set)
    for one in data if leg.base_rows else ():
        for link, down in one.contacts.items():
            read[link] |= {*np.unique(down).tolist()}
    feet = _flat_feet(leg, read)
    for one, link in product(data, [link for link in feet if len(read[link]) == 1]):
        others, always = [x for x in feet if x in one.contacts and x != link], max(read[link])
        if link not in one.contacts or not others:
            continue
        # of two feet that are said to rest at all times, either may move
        sure = [x for x in others if not always or len(read[x]) > 1]
        denied = partial(_denied, leg, link, sure, others, one)
        if (seconds := denied(one.q)) and (not always or all(denied(q) for _, q in angle_mistakes(one))):
            does = "turns against one that rests" if always else "is at rest while the base moves against it"
            what = f"the switch of {link} reads {int(always)} at all samples, and the foot {does}"
            remedy = f"mend this switch, which is dead: leave these logs out, or give the contact of {link} otherwise"
            raise UnreadableInputError(f"{what}, for {seconds:.2g} s", where=one.file_name, remedy=remedy)


def refuse_rolling_feet(leg: Leg, data: Sequence[Recording]) -> None:
    """Refuse walks on heel and toe where nothing but feet, which count as flat, says how the base moves."""
    for one in data if leg.base_rows else ():
        feet = _flat_feet(leg, one.contacts) if one.base is None else []
        # 0.00 on walkers, seeds 20 to 29, whose ground leans, rocks, slides or is soft; 1.00 in the rig's walk
        share = _turning(leg, feet, one, one.q)
        if share > 0.5 and all(_turning(leg, feet, one, q) > 0.5 for _, q in angle_mistakes(one)):
            what = f"for {share:.0%} of the time of steps one of two feet turns: feet roll from heel to toe"
            remedy = "record an IMU on the torso, or say when a foot is on its heel or toe: contact_<foot>_heel, …_toe"
            what = f"{what}, and do not say how the base moves"
            raise UnreadableInputError(what, where=one.file_name, remedy=remedy)


def _turning(leg: Leg, feet: Sequence[str], one: Recording, q: FloatArray) -> float:
    """Share of the time of steps from one foot to another in which they turn against each other; zero if short."""
    # On one foot alone, a base that turns and a foot that rolls look alike. Where the same foot stands before and
    # after, the other one bore nothing: its contact is wrong.
    slow, turned, both = slow_part(q, one.sample_rate, LOOK), 0, 0
    for pair in combinations(feet, 2):
        _, turns = _apart(*(motion_on(leg, link, slow, one.time) for link in pair))
        down = np.column_stack([one.contacts[link] for link in pair])
        changes = np.flatnonzero(np.diff(down.all(axis=1))) + 1
        for begin, end in pairwise(changes.tolist()):
            if down[begin].all() and (down[begin - 1] != down[end]).any():
                turned, both = turned + int(np.count_nonzero(turns[begin:end])), both + end - begin
    return turned / both if both > 0.1 * one.sample_rate else 0.0


def _flat_feet(leg: Leg, links: Collection[str]) -> list[str]:
    """Find feet whose contacts are flat: a torso in a harness is none, nor a foot with switches of heel and toe."""
    feet = (link for link in links if link != leg.description.root_link and leg.contact_kind(link) == "flat")
    return [link for link in feet if not any(f"{link}{part}" in links for part in ("_heel", "_toe"))]


def _denied(leg: Leg, link: str, sure: Sequence[str], others: Sequence[str], one: Recording, q: FloatArray) -> float:
    """Time for which the motion of a foot denies its switch, which never changes, where that is a large part [s]."""
    q, always = slow_part(q, one.sample_rate, LOOK), bool(one.contacts[link][0])
    on, cases = motion_on(leg, link, q, one.time), list[tuple[BoolArray, BoolArray]]()
    first = on.shape[1] - on.shape[1] // 2
    paced = always | (np.linalg.norm(on[:, :first], axis=1) > 2.0 * SLIDING)
    for other in sure:
        fast, turns = _apart(on, motion_on(leg, other, q, one.time))
        cases.append((one.contacts[other] & paced, turns if always else ~(fast | turns)))
    if one.base is not None and not always:  # while no foot is said to rest, a gyroscope tells how it turns
        rates = slow_part(one.base.angular_velocity, one.sample_rate, LOOK)
        rates = rates if first == 3 else -rates @ leg.plane.lateral[:, np.newaxis]
        _, turns = _apart(on, np.hstack([on[:, :first], rates]))
        cases.append((paced & ~np.any([one.contacts[x] for x in others], axis=0), ~turns))
    # of walkers, seeds 20 to 28, right switches are denied in 0.02 of that time at most, and dead ones in 0.6 at least
    found = [(np.count_nonzero(told & denied), np.count_nonzero(told)) for told, denied in cases]
    return max((x for x, of in found if x > max(one.sample_rate, 0.3 * of)), default=0) / one.sample_rate


def sliding(
    base: BaseMotion, still: Mapping[str, StandingBase], resting: Mapping[str, NDArray[np.bool_]], rate: float
) -> Slip:
    """Find slips that all feet make alike, by the measured motion of the base beside that on a foot at rest."""
    # The specific force f of an IMU, less that of a base on a foot that rests, is the acceleration of this foot. Its
    # integral is the velocity s of the foot, beside a drift by bias, tilt and noise that a running median takes out. A
    # slip is a generalised likelihood ratio test at each sample, s²/σ² > 6², with σ by the median size of s itself. It
    # lasts while s is beyond 3 σ.
    slides, visible, seen = np.zeros(len(base), dtype=np.bool_), 0.0, 6.0
    for link, flags in resting.items():
        inner = scipy.ndimage.binary_erosion(flags, iterations=max(1, round(ENDS * rate)))
        changes = np.flatnonzero(np.diff(inner, prepend=False, append=False)).reshape(-1, 2).tolist()
        runs = [slice(*ends) for ends in changes if ends[1] - ends[0] > BASELINE * rate]
        pose, aside = still[link].pose, base.specific_force - still[link].specific_force
        if not runs or pose is None:
            continue
        along = np.einsum("nij,nj->ni", pose.rotation[:, :2], aside)  # the ground, in level axes
        speeds = [_velocity(along[run], rate) for run in runs]
        std = np.maximum(robust_std(np.vstack(speeds)), 1e-3)  # soft soles move as much [m/s]
        for run, speed in zip(runs, speeds, strict=True):
            over = (np.abs(speed) / std).max(axis=1)
            pieces, _ = scipy.ndimage.label(over > 3.0)
            slides[run] |= np.isin(pieces, np.unique(pieces[over > seen]))
        visible = max(visible, seen * float(std.max()))
    return Slip(slides, visible)


def _velocity(acceleration: FloatArray, rate: float) -> FloatArray:
    """Integrate an acceleration, without what changes slowly, (N, 2)."""
    speed = slow_part(np.cumsum(acceleration, axis=0) / rate, rate, LOOK)
    stride = max(1, int(rate / (6.25 * LOOK)))  # the low-pass leaves no more than that
    half = round(0.5 * BASELINE * rate / stride)
    longer = np.pad(speed[::stride], ((half, half), (0, 0)), "reflect", reflect_type="odd")  # a drift has no ends
    slow = scipy.ndimage.median_filter(longer, (2 * half + 1, 1))
    slow = scipy.ndimage.uniform_filter1d(slow, 1 + half // 2, axis=0)[half:-half]
    time = np.arange(len(speed))
    return np.asarray(speed - np.column_stack([np.interp(time, time[::stride], of_axis) for of_axis in slow.T]))
