"""How feet stand that carry a base which was not measured: on soft soles, on ground that leans, or rocking."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.leg.leg import Leg
from exoid.signals import BaseMotion, Recording
from exoid.torques.contacts.imu import CorrectedBase, ImuErrors
from exoid.torques.contacts.standing_base import LEVEL, StandingBase, standing_base, tilt_of_sole

from .group_rows import Group
from .problem import Fitted, Problem
from .row_changes import Effects, RowChanges, change_recordings, row_changes

KNOT, COLOURS = 0.25, 6
"""Time between knots of a lean that varies [s]; every sixth is changed at once."""

SOLE, LEAN, BIAS, PIVOT, KNOTS = range(5)
"""Kinds of numbers of a footing, in their order."""

STEPS = 5e-5, LEVEL, 1.0, 0.02, 0.01
STDS = 1e-4, LEVEL, 1.0, 0.1, 0.01
"""Sizes at which effects of each kind are computed, and standard deviations before any log is seen: a sole of 10
kN·m/rad is soft, a foot reaches 0.1 m from its joint, and one that rocks does so by 10 mrad."""


class Footing(NamedTuple):
    """How feet stand that carry a base which was not measured, and bias of a sensor that did measure a base."""

    links: tuple[str, ...]  # these feet
    axes: FloatArray  # level axes about which the ground may lean, (A, 3)
    sensor: FloatArray  # biases of angular velocity and specific force, each of the size that sensors have, (B, 6)
    # compliance of each sole [rad/(N·m)], lean of the ground about each axis [rad], and multiples of the biases. Where
    # feet rock: places forward and up from the origin of each link about which they do [m], and lean by `knots` [rad]
    found: RowChanges
    # by the angles of a recording, numbers that are the lean of its foot beside that of the ground
    knots: Mapping[bytes, range] = MappingProxyType({})

    def part(self, kind: int) -> slice:
        """Place of the numbers of one kind."""
        links, knots = len(self.links), sum(map(len, self.knots.values()))
        counts = (links, len(self.axes), len(self.sensor), 2 * links if knots else 0, knots)
        first = sum(counts[:kind])
        return slice(first, first + counts[kind])

    @property
    def compliance(self) -> dict[str, float]:
        """Compliance of each sole [rad/(N·m)]."""
        return dict(zip(self.links, self.found.values.tolist(), strict=False))

    @property
    def lean(self) -> FloatArray:
        """Lean of the ground, a rotation vector [rad], (3,)."""
        return self.found.values[self.part(LEAN)] @ self.axes

    @property
    def imu(self) -> ImuErrors:
        """Bias of the inertial measurement unit, with zeros for what the motion does not show."""
        part = self.part(BIAS)
        bias, spread = self.found.values[part] @ self.sensor, self.found.spread[part, part]
        return ImuErrors(bias[:3], bias[3:], np.sqrt(np.diag(self.sensor.T @ spread @ self.sensor)))

    @property
    def pivots(self) -> dict[str, FloatArray]:
        """Place about which each foot rocks, forward and up from the origin of its link [m], (2,)."""
        return dict(zip(self.links, self.found.values[self.part(PIVOT)].reshape(-1, 2), strict=False))

    @property
    def rocks(self) -> float:
        """Standard deviation of the lean of a foot about that of the ground [rad]."""
        if self.knots:  # at its knots, a spline is this mean of its numbers
            each = [np.convolve(self.found.values[k], (1 / 6, 2 / 3, 1 / 6), "valid") for k in self.knots.values()]
            return float(np.std(np.concatenate(each)))
        variance = np.diag(self.found.spread)[self.part(LEAN)]
        return float(np.sqrt(variance.max(initial=0.0) * self.found.blocks))

    def carried(self, leg: Leg, one: Recording, link: str) -> StandingBase:
        """Motion of a base that one of the feet carries."""
        # It follows from the angles once more: a foot leans with the ground, on its sole, and as it rocks
        lean = self.lean + self.compliance.get(link, 0.0) * tilt_of_sole(leg, one, link)
        if (knots := self.knots.get(one.q.tobytes())) is None:
            return standing_base(leg, one, link, lean)
        spline = scipy.interpolate.BSpline(KNOT * np.arange(-3.0, len(knots) + 1.0), self.found.values[knots], 3)
        lean = lean + np.outer(spline(one.time - one.time[0]), leg.plane.lateral)
        return standing_base(leg, one, link, lean, self.pivots[link] @ (leg.plane.forward, leg.plane.up))


def find_footing(fitted: Fitted, about: Footing | None = None, *, rocking: bool = False) -> Footing | None:
    """Estimate compliance of soles, lean of the ground and bias of a sensor beside the parameters; None for none."""
    leg = fitted.models[0].leg
    data = fitted.problem.motions
    links = tuple(dict.fromkeys(one.base.link for one in data if isinstance(one.base, StandingBase)))
    # a lean of the ground turns gravity in what feet told, too
    stand = bool(links) or any(isinstance(one.base, CorrectedBase) and one.base.pose is None for one in data)
    biased = leg.base_rows and any(_may_be_biased(one.base) for one in data)
    if not stand and not biased:
        return None
    forward, lateral, up = leg.plane
    turns, pushes = (np.eye(3), np.eye(3)) if leg.base_rows == 6 else (np.array([lateral]), np.array([forward, up]))
    # biases of a sensor before any log is seen: 0.02 rad/s and 0.2 m/s² (standard deviations)
    axes, sensor = turns[: 2 * stand], scipy.linalg.block_diag(0.02 * turns, 0.2 * pushes)[: 6 * biased]
    count = len(links) + len(axes) + len(sensor)
    values, knots = (np.zeros(count), {}) if about is None else (about.found.values, dict(about.knots))
    if rocking and not knots:  # a foot that rocks leans otherwise at each time, by a cubic spline
        values = np.append(values, np.zeros(2 * len(links)))
        for one in data:
            if isinstance(one.base, StandingBase) and one.q.tobytes() not in knots:
                several = int((one.time[-1] - one.time[0]) / KNOT) + 4
                knots[one.q.tobytes()] = range(len(values), len(values) + several)
                values = np.append(values, np.zeros(several))
    none = np.zeros((len(values), len(values)))
    start = Footing(links, axes, sensor, RowChanges(values, none, none, none), knots)
    found, soles = row_changes(fitted, footing_effects(fitted, start)), len(links)
    free = values + found.values
    values = np.append(np.maximum(free[:soles], 0.0), free[soles:])
    # a compliance varies by a part of itself: soles are stiffer under more load
    doubt = (free - values) ** 2
    doubt[:soles] += (0.2 * values[:soles]) ** 2
    covariance, spread = found.covariance + np.diag(doubt), found.spread + np.diag(doubt)
    return start._replace(found=found._replace(values=values, covariance=covariance, spread=spread))


def footing_effects(fitted: Fitted, about: Footing) -> Effects:
    """Change each number of a footing."""
    # No row depends on two feet that carry the base, or on two knots of a colour: one change of the problem tells what
    # each of them does
    parts = [about.part(kind) for kind in range(5)]
    counts = [part.stop - part.start for part in parts]
    periods = 1, max(1, counts[LEAN]), max(1, counts[BIAS]), 2, COLOURS
    sizes = [*map(min, counts, periods)]
    colours = [sum(sizes[:k]) + np.arange(counts[k]) % periods[k] for k in range(5)]
    changes = [step * (np.concatenate(colours) == k) for k, step in enumerate(np.repeat(STEPS, sizes).tolist())]

    def numbers(one: Recording, time: FloatArray) -> NDArray[np.intp]:
        foot = about.links.index(one.base.link) if isinstance(one.base, StandingBase) else 0
        pivot = parts[PIVOT].start + 2 * foot
        fixed = [*range(foot, foot + sizes[SOLE]), *range(parts[LEAN].start, parts[BIAS].stop)]
        fixed += range(pivot, pivot + sizes[PIVOT])
        own = about.knots.get(one.q.tobytes(), range(0))
        k = own.start + np.floor((time[:, np.newaxis] - one.time[0]) / KNOT).astype(np.intp) - 1
        k = k + (np.arange(sizes[KNOTS]) + parts[KNOTS].start - k) % COLOURS
        return np.hstack([np.tile(fixed, (len(time), 1)), np.where((k >= own.start) & (k < own.stop), k, -1)])

    moved = [about._replace(found=about.found._replace(values=about.found.values + change)) for change in changes]
    others = [tilted(fitted.problem, each, about) for each in moved]
    return Effects(others, np.repeat(STEPS, sizes), np.repeat(STDS, counts), -about.found.values, numbers)


def tilted(problem: Problem, footing: Footing, before: Footing | None = None) -> Problem:
    """Let the feet that carry the base tilt on their soles, and the ground lean; take the bias of the sensor out."""
    imu = footing.imu
    if before is not None:  # of a bias, a part has been taken out
        gone = before.imu
        imu = imu._replace(gyro_bias=imu.gyro_bias - gone.gyro_bias, force_bias=imu.force_bias - gone.force_bias)

    def tilt(group: Group, one: Recording) -> Recording:
        if isinstance(one.base, StandingBase):
            return replace(one, base=footing.carried(group.model.leg, one, one.base.link))
        if isinstance(one.base, CorrectedBase) and one.base.pose is None:
            return replace(one, base=one.base.leaning(footing.lean))
        if one.base is None or not _may_be_biased(one.base):
            return one
        return replace(one, base=replace(imu.corrected(one.base), calibrated=False))

    return change_recordings(problem, tilt)


def _may_be_biased(base: BaseMotion | None) -> bool:
    """Whether a base was measured by a sensor whose bias is neither known nor taken out."""
    return base is not None and base.pose is None and not base.calibrated and not isinstance(base, CorrectedBase)
