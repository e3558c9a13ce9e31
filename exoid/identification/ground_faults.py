"""Faults of single joints of a leg on the ground, such as a torque out of scale, and of its measured wrenches."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import combinations, starmap
from typing import NamedTuple

import numpy as np
import pinocchio as pin
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.estimate.finding import Finding, Severity
from exoid.leg.link_frames import ball_radius
from exoid.regression.diagnostics import other_scale
from exoid.regression.least_squares import TINY, scaled_inverse
from exoid.signals import Recording, Wrench, ZeroPhase
from exoid.signals.contacts import LEAST_LOAD
from exoid.signals.link_wrenches import link_placements
from exoid.torques.contacts.standing_base import StandingBase, level_rotation

from .findings.efforts import FITS_BETTER
from .findings.kinds import KINDS, Nuisance, without_offset
from .findings.score import in_half_widths
from .findings.search import DOUBTFUL_MOVE, FAR_MOVE
from .footing import Footing, footing_effects
from .group_rows import Group
from .problem import Fitted, Problem
from .row_changes import OTHER_LOG, Effects, beside, best_reading, change_recordings, equations, on_points, residual

SIZES = {
    "torque-scale": (0.02, 0.3, "1", 4.0),
    "angle-offset": (np.deg2rad(0.5), 0.1, "rad", 4.0),
    "unmodelled-force": (1.0, 100.0, "N·m/rad", 4.0),
    "torque-offset": (1.0, 100.0, "N·m", 3.0),
    "known-torque": (0.02, 10.0, "1", 4.0),
    "wrench-delay": (2e-3, 0.1, "s", 4.0),
    "gravity-direction": (np.deg2rad(0.5), 0.1, "rad", 4.0),
    "contact-place": (2e-3, 0.05, "m", 4.0),
    "clock": (1e-3, 0.2, "1", 4.0),
}
"""Step at which effects are computed, standard deviation before any log is seen, and unit of the size s of each kind,
and how many standard deviations of correlated noise it is from zero at least. Healthy walkers (seeds 20 to 34, with and
without IMU) reach 3.1, constant torques 1.7.

Without the fault the torque is τ (1 + s), the angle q − s, or the torque τ − s q or τ − s, in the joint's direction;
or measured wrenches are 1 + s times as large, or read s later, gravity is turned about a level axis by s, a contact is
s further along an axis, or times are 1 + s times as large.
"""

Place = int | tuple[str, int]
"""What a fault acts on: a joint, a number below zero for all, or a link and an axis: forward, left or up."""


class Trial(NamedTuple):
    """What faults explain beside the parameters."""

    faults: tuple[int, ...]  # which
    gain: float  # squared residuals that they explain
    values: FloatArray  # their sizes, (K,)
    stds: FloatArray  # (K,)
    moves: FloatArray  # change of the parameters, (P,)


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
    every = range(len(fitted.problem.groups))
    for name, described, tables, of_rows in logs.values():
        table = np.hstack(tables)
        if scaled and (scale := other_scale(table[:3])) != 1.0 and best_reading(fitted.problem, every)[0] is None:
            text = f"all torques of {described} are {scale:.2g} times what the other logs say"
            yield Finding("torque-scale", "", scale, "1", "error", text, OTHER_LOG, None, fitted.problem.names, name)
        shares = np.sqrt(table[2] / (np.maximum(table[3], 1.0) * [most[row] or np.inf for row in of_rows]))
        row, share = of_rows[int(np.argmax(shares))], float(shares.max())  # a passive row has none
        # rows with more lose their weight in silence. Healthy walkers leave 0.18, and 0.28 on feet that rock
        if not scaled and share > (0.4 if any(one.kind == "rocking-foot" for one in fitted.findings) else 0.25):
            text = f"{share:.0%} of the torque of {row} is unexplained in {described}"
            yield Finding("large-residual", row, share, "1", "warning", text, OTHER_LOG, recording=name)


def joint_faults(fitted: Fitted, footing: Footing | None) -> Iterator[Finding]:
    """Find the fault, or angles of two joints, that explains most, and what explains about as much."""
    names, leg, count = fitted.models[0].leg.joint_names, fitted.models[0].leg, len(fitted.problem.names)
    if any(model.leg.joint_names != names for model in fitted.models):
        return
    passive = {name for one in fitted.problem.motions for name in one.passive}  # their torque is no measurement
    joints = [joint for joint, name in enumerate(names) if name not in passive]
    unbiased = [joint for joint in without_offset(fitted.models[0]) if joint in joints]
    sensed = [link for one in fitted.problem.motions for link in _loaded(one)]
    every, leans = [-1] * bool(sensed), [-2, -3] if leg.base == "fixed" and not leg.limbs else []  # about level axes
    at = [(link, axis) for link in on_points(fitted, sensed) for axis in ((0, 2) if leg.limbs else (0, 1, 2))]
    acts_on: dict[str, Sequence[Place]] = {"angle-offset": range(len(names)), "torque-offset": unbiased, "clock": [-1]}
    acts_on |= {"known-torque": every, "wrench-delay": every, "gravity-direction": leans, "contact-place": at}
    faults = [(kind, place) for kind in SIZES for place in acts_on.get(kind, joints)]
    found = equations(fitted, _effects(fitted, footing, faults))
    # Each is tried beside the numbers of the footing: a lean may imitate a zero. Zeros of two angles hide each other
    free = np.flatnonzero(found.free[: -len(faults)])
    plain = scaled_inverse(found.information[np.ix_(free, free)]) @ found.right[free]
    own, labels = free[free < count], dict[Place, str](enumerate(names)) | {place: place[0] for place in at}

    def tried(*each: int) -> Trial:
        tested = np.append(free, len(found.free) - len(faults) + np.array(each))
        inverse = scaled_inverse(found.information[np.ix_(tested, tested)])
        solution, moves = inverse @ found.right[tested], np.zeros(count)
        gain = float(found.right[tested] @ solution - found.right[free] @ plain)
        moves[own] = solution[: len(own)] - plain[: len(own)]
        # Residuals are correlated, and rows count by a third, as for delays. Blocks of time have to agree: jolts look
        # like any fault for a while. Of two numbers more is asked
        agree = min(0.5, 0.2 * np.sqrt(len(found.scores))) * np.linalg.norm(found.scores[:, tested] @ inverse, axis=0)
        stds = np.maximum(np.sqrt(3.0 * np.diag(inverse)), agree)[len(free) :]
        return Trial(each, gain if len(each) == 1 else gain / 1.5, solution[len(free) :], stds, moves)

    angles = [k for k, (kind, _) in enumerate(faults) if kind == "angle-offset"]
    trials = [*map(tried, range(len(faults))), *starmap(tried, combinations(angles, 2))]
    trials.sort(key=lambda trial: -trial.gain)
    best, mended = trials[0], fitted.problem
    flipped = faults[best.faults[0]][0] == "torque-scale" and best.values[0] < -1.5  # a sign: readings of torques tell
    # scales of 1.1 and angles 3° off explain 0.18 of the squared residuals
    if best.gain < 0.02 * found.squares or flipped:
        return
    for k, size in zip(best.faults, best.values.tolist(), strict=True):
        mended = _mended(mended, footing, *faults[k], size)
    reading, gain = best_reading(fitted.problem, range(len(fitted.problem.groups)), mended)
    # what a fault leaves unexplained counts as noise: a wrench of 1.1 times is 3.4 of its standard deviations (seed 4)
    small = np.abs(best.values) < np.array([SIZES[faults[k][0]][3] for k in best.faults]) * best.stds
    if reading is not None or (small.any() and gain < 2.0 * np.log(FITS_BETTER)):
        return  # torques of other signs, or in another order; or noise
    alike = [trial for trial in trials if trial.gain > 0.8 * best.gain]
    at_of = [" at ".join(filter(None, (kind, labels.get(place)))) for kind, place in faults]
    words = [" and ".join(at_of[k] for k in trial.faults) for trial in alike]
    for trial, itself in zip(alike, words, strict=True):
        others = " or ".join(x for x in dict.fromkeys(words) if x != itself)
        more = f"; {others} would explain this log about as well" if others else ""
        yield from _described(fitted, trial, [faults[k] for k in trial.faults], labels, more)


def _described(
    fitted: Fitted, trial: Trial, faults: Sequence[tuple[str, Place]], labels: Mapping[Place, str], more: str
) -> Iterator[Finding]:
    """Describe each of the faults that were tried together."""
    moved = in_half_widths(trial.moves, 2.0 * np.sqrt(np.diag(fitted.fit.solution.covariance)))
    names = tuple(fitted.problem.names[each] for each in np.flatnonzero(moved > DOUBTFUL_MOVE))
    for (kind, place), value, std in zip(faults, trial.values, trial.stds, strict=True):
        unit, told, ends = SIZES[kind][2], KINDS[kind], value + np.array([0.0, -2.0, 2.0]) * std
        if kind == "torque-scale":  # of the log over what it should be
            ends = 1.0 / np.maximum(1.0 + ends, 1e-3)
        elif kind == "clock":  # accelerations change by the square of the time
            ends = np.sqrt(np.maximum(1.0 - 2.0 * ends, 1e-3)) - 1.0
        ends += kind == "known-torque"
        where, ways = labels.get(place, ""), (("before", "behind"), ("left of", "right of"), ("above", "below"))
        way = "" if isinstance(place, int) else ways[place[1]][int(value < 0.0)]
        text = told.message(Nuisance(kind, where, -1, unit, (), way), float(ends[0]), np.array([value])) + more
        joint, interval = where if isinstance(place, int) else "", (float(ends.min()), float(ends.max()))
        small = abs(value) < (told.least or 0.0)  # such as a thousandth of a force, which no sensor keeps
        severity: Severity = "error" if moved.max(initial=0.0) > FAR_MOVE and not small else "warning"
        yield Finding(kind, joint, float(ends[0]), unit, severity, text, told.remedy, interval, names)


def moving_points(fitted: Fitted) -> Iterator[Finding]:
    """Find points that would move while they rest on the ground: another place on their link rests."""
    leg, told = fitted.models[0].leg, KINDS["contact-place"]
    every = on_points(fitted, [link for one in fitted.problem.motions for link in one.contacts])
    for link in every if leg.base == "fixed" and not leg.limbs else ():
        pieces, flat = [np.zeros((0, 3 + len(leg.joint_names)))], level_rotation(leg, link)
        for one in fitted.problem.motions if not ball_radius(leg, link) else ():
            settled = round(0.1 * one.sample_rate)
            rests = scipy.ndimage.binary_erosion(one.contacts.get(link, np.zeros(len(one))), iterations=settled)
            q = scipy.ndimage.gaussian_filter1d(one.q, 0.1 * settled, axis=0)
            for start, stop in np.flatnonzero(np.diff(rests, prepend=False, append=False)).reshape(-1, 2).tolist():
                rotation, position = link_placements(leg, q[start:stop], link)
                turned = (link_placements(leg, q[start:stop] + 1e-5 * e, link)[1] for e in np.eye(len(leg.joint_names)))
                axes = (rotation @ flat.T @ axis for axis in (leg.plane.forward, leg.plane.up))
                columns = np.stack([position, *axes, *(1e5 * (x - position) for x in turned)], axis=-1)
                pieces.append((columns - columns.mean(axis=0)).reshape(-1, columns.shape[2]))
        # The place p + R δ of a point at rest does not change. A joint whose zero is wrong explains that, too
        moves, places, zeros = np.split(np.vstack(pieces), [1, 3], axis=1)
        aside = -np.linalg.lstsq(places, moves[:, 0])[0]
        left = np.sum((moves[:, 0] + places @ aside) ** 2)
        of_joints = np.sum(moves**2) - (zeros.T @ moves[:, 0]) ** 2 / np.maximum(np.sum(zeros**2, axis=0), TINY)
        # right places are less than 0.8 mm aside, as the ground yields (three hoppers, seeds 1 to 3)
        k = int(np.argmax(np.abs(aside)))
        if abs(aside[k]) > 3e-3 and left < min(0.5 * np.sum(moves**2), of_joints.min()):
            size, way = float(aside[k]), (("before", "behind"), ("above", "below"))[k][int(aside[k] < 0.0)]
            text = told.message(Nuisance("contact-place", link, -1, "m", (), way), size, np.array([size]))
            yield Finding("contact-place", "", size, "m", "error", text, told.remedy, None, fitted.problem.names)


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
    if kind not in ("gravity-direction", "clock"):
        torques = kind in ("torque-scale", "unmodelled-force", "torque-offset")
        return change_recordings(problem, partial(_without, footing, kind, joint, size), torques=torques)
    groups = []
    for group in problem.groups:
        if kind == "clock":  # filters count samples: their cut-offs change with the rate
            data, filters = [replace(one, time=(1.0 + size) * one.time) for one in group.motions], group.preparation
            if isinstance(filters, ZeroPhase):
                of_motion = filters.kinematics_cutoff and filters.kinematics_cutoff / (1.0 + size)
                filters = ZeroPhase(filters.cutoff / (1.0 + size), of_motion)
            groups.append(replace(group, data=tuple(data), preparation=filters))
            continue
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
