"""Links that are said to rest and move: against each other, or against an inertial measurement unit."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import BoolArray, FloatArray
from exoid.leg.leg import Leg
from exoid.leg.link_frames import ball_radius, lowest_point
from exoid.signals import BaseMotion
from exoid.signals.cutoff import robust_std
from exoid.signals.filters.low_pass import slow_part
from exoid.signals.link_wrenches import link_placements

from .imu import ENDS
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
    slips, base, v = np.zeros(len(q), dtype=np.bool_), leg.base_rows, np.gradient(q, time, axis=0)
    if not base:
        for link, flags in rest.items():
            twist = np.einsum("ncj,nj->nc", leg.frame_jacobian(q, link, lowest_point(leg, q, link)), v)
            turns = (np.linalg.norm(twist[:, 3:], axis=1) > TILTING) & (leg.contact_kind(link) == "flat")
            slips |= flags & (turns | (np.linalg.norm(twist[:, :3], axis=1) > SLIDING))
    levers, places = dict[str, FloatArray](), dict[str, FloatArray]()
    for link in rest if base else ():
        if ball_radius(leg, link):  # distances of balls that roll change
            continue
        if leg.contact_kind(link) != "flat":
            places[link] = link_placements(leg, q, link).translation
            continue
        jacobian = leg.contact_jacobian(q, link)
        to_base = np.linalg.solve(jacobian[..., :base], np.einsum("ncj,nj->nc", jacobian[..., base:], v)[..., None])
        levers[link] = -to_base[..., 0]
    # Base rows of a planar machine
    turning = slice(2, 3) if base == 3 else slice(3, 6)
    for (link, flags), (other, also) in combinations(rest.items() if base else (), 2):
        if link in places and other in places:  # however the base turns, two points that rest keep their distance
            distance = np.linalg.norm(places[link] - places[other], axis=1)
            slips |= flags & also & (np.abs(np.gradient(distance, time)) > SLIDING)
        elif link in levers and other in levers:
            apart = levers[link] - levers[other]  # linear before angular
            fast = np.linalg.norm(apart[:, : turning.start], axis=1) > SLIDING
            slips |= flags & also & (fast | (np.linalg.norm(apart[:, turning], axis=1) > TILTING))
    return np.asarray(scipy.ndimage.binary_dilation(slips, iterations=max(1, widened))) if slips.any() else slips


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
