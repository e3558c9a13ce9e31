"""Faults of single joints of a leg on the ground, such as a torque out of scale, and of its measured wrenches."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import pinocchio as pin
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.estimate.finding import Finding, Severity
from exoid.regression.diagnostics import other_scale
from exoid.regression.least_squares import scaled_inverse
from exoid.signals import Recording, Wrench
from exoid.signals.contacts import LEAST_LOAD
from exoid.torques.contacts.standing_base import StandingBase

from .findings.kinds import KINDS, Nuisance, without_offset
from .findings.score import in_half_widths
from .findings.search import DOUBTFUL_MOVE, FAR_MOVE
from .footing import Footing, footing_effects
from .group_rows import Group
from .problem import Fitted, Problem
from .row_changes import Effects, beside, best_reading, change_recordings, equations, on_points, residual

SIZES = {
    "torque-scale": (0.02, 0.3, "1", 4.0),
    "angle-offset": (np.deg2rad(0.5), 0.1, "rad", 4.0),
    "unmodelled-force": (1.0, 100.0, "N·m/rad", 4.0),
    "torque-offset": (1.0, 100.0, "N·m", 3.0),
    "known-torque": (0.02, 10.0, "1", 4.0),
    "wrench-delay": (2e-3, 0.1, "s", 4.0),
    "gravity-direction": (np.deg2rad(0.5), 0.1, "rad", 4.0),
    "contact-place": (2e-3, 0.05, "m", 4.0),
}
"""Step at which effects are computed, standard deviation before any log is seen, and unit of the size s of each kind,
and how many standard deviations of correlated noise it is from zero at least. Healthy walkers (seeds 20 to 34, with and
without IMU) reach 3.1, constant torques 1.7.

Without the fault the torque is τ (1 + s), the angle q − s, or the torque τ − s q or τ − s, in the joint's direction;
or measured wrenches are 1 + s times as large, or read s later, gravity is turned about a level axis by s, or a contact
is s further along an axis.
"""

Place = int | tuple[str, int]
"""What a fault acts on: a joint, a number below zero for all, or a link and an axis: forward, left or up."""


def unlike_logs(fitted: Fitted, *, scaled: bool) -> Iterator[Finding]:
    """Find recordings whose torques have another scale than those of the others, or that the fit does not explain."""
    logs, most = dict[bytes, tuple[str, str, list[FloatArray], list[str]]](), defaultdict[str, float](float)
    for k, group in enumerate(fitted.problem.groups):
        for index, one in enumerate(group.motions):
            rows, described = group.decimated(index), f"a recording of {one.duration:.4g} s with {group.links}"
            left = residual(rows, fitted.values(k))
            fit = np.where(rows.usable, rows.tau, 0.0) - left
            table = np.sum([fit * fit, fit * left, left * left, rows.usable], axis=1)
            sizes = np.sum((fit + left) ** 2, axis=0) / np.maximum(table[3], 1.0)
            most |= {row: max(most[row], x) for row, x in zip(group.model.row_names, sizes.tolist(), strict=True)}
            # supports of a recording share its angles
            *_, tables, of_rows = logs.setdefault(one.q.tobytes(), (one.file_name, one.file_name or described, [], []))
            tables.append(table)
            of_rows.extend(group.model.row_names)
    remedy = "look for a load (payloads=), a contact, a sign, a unit or a clock that differs in this log"
    every = range(len(fitted.problem.groups))
    for name, described, tables, of_rows in logs.values():
        table = np.hstack(tables)
        if scaled and (scale := other_scale(table[:3])) != 1.0 and best_reading(fitted.problem, every) is None:
            text = f"all torques of {described} are {scale:.2g} times what the other logs say"
            yield Finding("torque-scale", "", scale, "1", "error", text, remedy, None, fitted.problem.names, name)
        shares = np.sqrt(table[2] / (np.maximum(table[3], 1.0) * [most[row] or np.inf for row in of_rows]))
        row, share = of_rows[int(np.argmax(shares))], float(shares.max())  # a passive row has none
        # healthy walkers leave 0.18 where feet rock (seeds 20 to 34); rows with more lose their weight in silence
        if not scaled and share > 0.25:
            text = f"{share:.0%} of the torque of {row} is unexplained in {described}"
            yield Finding("large-residual", row, share, "1", "warning", text, remedy, recording=name)


def joint_faults(fitted: Fitted, footing: Footing | None) -> Iterator[Finding]:
    """Find the fault of a joint, a contact or all wrenches that explains most, and those that explain about as much."""
    names, leg, count = fitted.models[0].leg.joint_names, fitted.models[0].leg, len(fitted.problem.names)
    if any(model.leg.joint_names != names for model in fitted.models):
        return
    passive = {name for one in fitted.problem.motions for name in one.passive}  # their torque is no measurement
    joints = [joint for joint, name in enumerate(names) if name not in passive]
    unbiased = [joint for joint in without_offset(fitted.models[0]) if joint in joints]
    sensed = [link for one in fitted.problem.motions for link in _loaded(one)]
    every, leans = [-1] * bool(sensed), [-2, -3] if leg.base == "fixed" and not leg.limbs else []  # about level axes
    at = [(link, axis) for link in on_points(fitted, sensed) for axis in ((0, 2) if leg.limbs else (0, 1, 2))]
    acts_on: dict[str, Sequence[Place]] = {"angle-offset": range(len(names)), "torque-offset": unbiased}
    acts_on |= {"known-torque": every, "wrench-delay": every, "gravity-direction": leans, "contact-place": at}
    faults = [(kind, place) for kind in SIZES for place in acts_on.get(kind, joints)]
    found = equations(fitted, _effects(fitted, footing, faults))
    # Each is tried alone, beside the numbers of the footing: a lean of the ground may imitate a zero
    free = np.flatnonzero(found.free[: -len(faults)])
    plain = scaled_inverse(found.information[np.ix_(free, free)]) @ found.right[free]
    gains, values, stds = np.zeros((3, len(faults)))
    moves, own = np.zeros((len(faults), count)), free[free < count]
    for k in range(len(faults)):
        tested = np.append(free, len(found.free) - len(faults) + k)
        inverse = scaled_inverse(found.information[np.ix_(tested, tested)])
        solution = inverse @ found.right[tested]
        gains[k] = found.right[tested] @ solution - found.right[free] @ plain
        # Residuals are correlated, and rows count by a third, as for delays
        values[k], stds[k] = solution[-1], np.sqrt(3.0 * inverse[-1, -1])
        moves[k, own] = solution[: len(own)] - plain[: len(own)]
    best = int(np.argmax(gains))
    flipped = faults[best][0] == "torque-scale" and values[best] < -1.5  # a sign: readings of the torques tell
    # scales of 1.1 and angles 3° off explain 0.18 of the squared residuals
    if gains[best] < 0.02 * found.squares or abs(values[best]) < SIZES[faults[best][0]][3] * stds[best] or flipped:
        return
    groups, mended = range(len(fitted.problem.groups)), _mended(fitted.problem, footing, *faults[best], values[best])
    if best_reading(fitted.problem, groups, mended) is not None:  # torques of other signs, or in another order
        return
    labels = dict[Place, str](enumerate(names)) | {place: place[0] for place in at}
    alike = [k for k in np.argsort(-gains).tolist() if gains[k] > 0.8 * gains[best]]
    for k in alike:
        (kind, place), (_, _, unit, _), told = faults[k], SIZES[faults[k][0]], KINDS[faults[k][0]]
        ends = values[k] + np.array([0.0, -2.0, 2.0]) * stds[k]
        if kind == "torque-scale":  # of the log over what it should be
            ends = 1.0 / np.maximum(1.0 + ends, 1e-3)
        ends += kind == "known-torque"
        where, ways = labels.get(place, ""), (("before", "behind"), ("left of", "right of"), ("above", "below"))
        way = "" if isinstance(place, int) else ways[place[1]][int(values[k] < 0.0)]
        text = told.message(Nuisance(kind, where, -1, unit, (), way), float(ends[0]), values[[k]])
        places = (filter(None, (faults[x][0], labels.get(faults[x][1]))) for x in alike if x != k)
        others = " or ".join(dict.fromkeys(" at ".join(place) for place in places))
        more = f"; {others} would explain this log about as well" if others else ""
        moved = in_half_widths(moves[k], 2.0 * np.sqrt(np.diag(fitted.fit.solution.covariance)))
        small = abs(values[k]) < (told.least or 0.0)  # such as a thousandth of a force, which no sensor keeps
        severity: Severity = "error" if moved.max(initial=0.0) > FAR_MOVE and not small else "warning"
        yield Finding(
            *(kind, where if where in names else "", float(ends[0]), unit, severity, text + more, told.remedy),
            (float(ends.min()), float(ends.max())),
            tuple(fitted.problem.names[each] for each in np.flatnonzero(moved > DOUBTFUL_MOVE)),
        )


def _loaded(one: Recording) -> dict[str, Wrench]:
    """Measured wrenches that bear a load; noise of the others would look like ones that act less."""
    return {link: x for link, x in one.wrenches.items() if np.linalg.norm(x.force.mean(axis=0)) > LEAST_LOAD}


def _effects(fitted: Fitted, footing: Footing | None, faults: list[tuple[str, Place]]) -> Effects:
    """Take a small fault out of all recordings, each behind the numbers of a footing."""
    others = [_mended(fitted.problem, footing, *one, SIZES[one[0]][0]) for one in faults]
    steps, stds = np.array([SIZES[kind][:2] for kind, _ in faults]).T
    scales = [k for k, (kind, _) in enumerate(faults) if kind == "torque-scale"]
    if footing is None:
        return Effects(others, steps, stds, 0.0 * stds, None, scales)
    about = footing_effects(fitted, footing)
    first, numbers = len(about.prior_std), about.numbers

    def of_rows(one: Recording, time: FloatArray) -> NDArray[np.intp]:
        assert numbers is not None
        return np.hstack([numbers(one, time), np.tile(first + np.arange(len(faults)), (len(time), 1))])

    sizes = zip((about.steps, about.prior_std, about.prior_mean), (steps, stds, 0.0 * stds), strict=True)
    steps, stds, means = (np.append(*pair) for pair in sizes)
    return Effects([*about.others, *others], steps, stds, means, of_rows, [len(about.others) + k for k in scales])


def _mended(problem: Problem, footing: Footing | None, kind: str, joint: Place, size: float) -> Problem:
    """Take a fault of a size out of all recordings, or a lean of a fixed base or a place of a contact of the model."""
    if not isinstance(joint, int):
        return beside(problem, *joint, size)
    if kind != "gravity-direction":
        return change_recordings(problem, partial(_without, footing, kind, joint, size))
    groups = []
    for group in problem.groups:
        leg, model = group.model.leg, group.model.leg.model.copy()
        model.gravity.linear = pin.exp3(size * leg.plane[joint]) @ model.gravity.linear
        groups.append(replace(group, model=replace(group.model, leg=replace(leg, model=model))))
    return replace(problem, groups=tuple(groups))


def _without(footing: Footing | None, kind: str, joint: int, size: float, group: Group, one: Recording) -> Recording:
    """Take a fault of a size out of a recording."""
    if kind in ("known-torque", "wrench-delay"):
        at = np.clip(one.time + size * (kind == "wrench-delay"), one.time[0], one.time[-1])
        read, wrenches = partial(scipy.interpolate.CubicSpline, one.time), dict(one.wrenches)
        factor = 1.0 + size * (kind == "known-torque")
        for link, x in _loaded(one).items():
            wrenches[link] = replace(x, force=factor * read(x.force)(at), moment=factor * read(x.moment)(at))
        return replace(one, wrenches=wrenches)
    own = size * (np.arange(len(group.model.leg.joint_names)) == joint)
    if kind != "angle-offset":
        if one.tau is None:
            return one
        of_joint = {"torque-scale": one.tau, "unmodelled-force": -one.q, "torque-offset": -np.ones_like(one.q)}[kind]
        return replace(one, tau=one.tau + own * of_joint)
    one = replace(one, q=one.q - own)
    if footing is None or not isinstance(one.base, StandingBase):
        return one
    return replace(one, base=footing.carried(group.model.leg, one, one.base.link))
