"""Numbers beside the parameters of a leg on the ground: late, swapped and turned torques, places of contacts."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate.finding import Finding
from exoid.estimate.ground_validation import BLOCK
from exoid.leg.link_frames import held_directions, link_frame
from exoid.regression.fit import wls
from exoid.regression.least_squares import TINY, rms_residual, scaled_inverse
from exoid.regression.row_data import Rows
from exoid.signals import Recording, Recordings, without_torque_delay
from exoid.torques.contacts.support_model import SupportModel

from .findings.efforts import CLEARLY, FITS_BETTER, POOR
from .findings.kinds import KINDS
from .findings.readings import Reading, readings
from .findings.sample import few_of
from .group_rows import Group
from .problem import Fitted, Problem

OTHER_LOG = "look for a load (payloads=), a contact, a sign, a unit or a clock that differs in this log"
"""Remedy for a log that is unlike the others."""


class RowChanges(NamedTuple):
    """Numbers c that change rows, r(c) = r − D c, found beside the parameters."""

    values: FloatArray  # c, (K,)
    covariance: FloatArray  # its covariance for white noise, (K, K)
    slopes: FloatArray  # change of the parameters by c, ∂β/∂c, (P, K)
    spread: FloatArray  # covariance of c for noise that is correlated within BLOCK, at least that for white noise
    blocks: int = 0  # number of blocks of rows

    @property
    def halves(self) -> FloatArray:
        """Half widths of 95 % intervals, (K,)."""
        # Residuals are correlated: rows count by a third. On 60 machines without delay, of 80 values none was beyond
        # 4.5 standard deviations for white noise; of 18 torques that were 40 ms late, 16 were beyond 7.
        return np.asarray(2.0 * np.sqrt(3.0 * np.diag(self.covariance)))


class Effects(NamedTuple):
    """Problems in which numbers beside the parameters have the size of their step, and what is known of the numbers."""

    others: Sequence[Problem]  # C of them
    steps: FloatArray  # sizes of the steps, (C,)
    prior_std: FloatArray  # standard deviations before any log is seen, (K,)
    prior_mean: FloatArray  # (K,)
    # where a problem changes several numbers: on which of them each row depends, (N, C), or −1
    numbers: Callable[[Recording, FloatArray], NDArray[np.intp]] | None = None
    scales: Sequence[int] = ()  # problems in which the measured torque of a joint is scaled


class Equations(NamedTuple):
    """Normal equations of the parameters β and of numbers c beside them, r = W δβ + D c, with c ~ N(m, σ²)."""

    information: FloatArray  # (P + K, P + K)
    right: FloatArray  # (P + K,)
    prior: FloatArray  # what was known before, inverse variances, (P + K,)
    scores: FloatArray  # Wᵀr and Dᵀr of each block of rows, (B, P + K)
    free: NDArray[np.bool_]  # (P + K,)
    squares: float  # rᵀr, weighted
    blocks: int  # number of blocks of rows, supports of a recording together


def torque_delays(fitted: Fitted, parts: Sequence[int]) -> tuple[FloatArray, FloatArray]:
    """Find delays of torques of some groups [s], 0 where none is significant, and half widths of their intervals."""
    problem, joints = fitted.problem, fitted.models[parts[0]].leg.joint_names
    if any(one.kind in ("wrench-delay", "known-torque") for one in fitted.findings):  # torques look early beside them
        return np.zeros(len(joints)), np.zeros(len(joints))

    def shifted(delays: Mapping[int, float]) -> Problem:
        return change_recordings(problem, lambda _, one: without_torque_delay(one, delays), parts, torques=True)

    step, each = 2e-3, np.ones(len(joints))  # [s]
    late = [shifted({joint: step}) for joint in range(len(joints))]
    found = row_changes(fitted, Effects(late, step * each, 0.1 * each, 0.0 * each))
    half = np.maximum(found.halves, min(1.33, 0.5 * np.sqrt(found.blocks)) * np.sqrt(np.diag(found.spread)))
    # A torque that is shifted by less than a fifth of a millisecond is as good as on time
    size = np.where(np.abs(found.values) > 2e-4, np.abs(found.values), 0.0)
    doubtful = (size > 0.5 * half) & (size < 1.5 * half)
    if doubtful.any():  # the residuals that tell the noise contain the delay: take it out, and see what is left
        on_time = shifted({k: float(found.values[k]) for k in np.flatnonzero(size > 0.5 * half).tolist()})
        left = rms_residuals(on_time, parts, wls(on_time).solution.values)
        left /= np.maximum(rms_residuals(problem, parts, fitted.fit.solution.values), TINY)
        rows = [name for k in parts for name in problem.groups[k].model.row_names]  # of joints, or combinations of them
        share = [max((x for x, row in zip(left, rows, strict=True) if row == name), default=1.0) for name in joints]
        half = np.where(doubtful, half * np.minimum(share, 1.0), half)
    return np.where(size > 1.5 * half, found.values, 0.0), half


def contact_offsets(fitted: Fitted) -> Iterator[Finding]:
    """Find points and edges whose force passes beside them: a foot that rolls, or that rests on another part."""
    step = 2e-3  # [m]
    found = {link: beside(fitted.problem, link, 0, step) for link in on_points(fitted)}
    if not found:
        return
    each = np.ones(len(found))
    c = row_changes(fitted, Effects([*found.values()], step * each, 0.05 * each, 0.0 * each))
    for link, x, band in zip(found, c.values.tolist(), c.halves.tolist(), strict=True):
        # Edges round by 5 mm stay below 0.7 mm; of 10 mm, four of five seeds are above (0 to 4). A contact that
        # bears hardly any load is known worse than to 5 mm, and moves no parameter.
        if abs(x) > max(band, 7e-4) and band < 5e-3:
            text = f"the force on {link} passes {1e3 * x:.2g} ± {1e3 * band:.2g} mm before the place that it rests on"
            remedy = "measure this place; of a foot that rolls on an edge, give the contact of the whole foot"
            yield Finding("contact-kind", "", x, "m", "warning", text, remedy, (x - band, x + band))


def on_points(fitted: Fitted, others: Iterable[str] = ()) -> list[str]:
    """Feet that rest on points and edges, by an unknown force or among others."""
    leg = fitted.models[0].leg
    unknown = (link for model in fitted.models if isinstance(model, SupportModel) for link in model.links)
    feet = [link for link in dict.fromkeys((*unknown, *others)) if leg.contact_kind(link) != "flat"]
    frames = ((link, link_frame(leg.model, leg.description, link)) for link in feet if leg.model.existFrame(link))
    return [link for link, frame in frames if frame.body >= 0]


def beside(problem: Problem, link: str, axis: int, step: float) -> Problem:
    """Let a foot rest a step before, left of or above its place [m]."""
    groups = []
    for group in problem.groups:
        leg, model = group.model.leg, group.model.leg.model.copy()
        frame = model.frames[model.getFrameId(link, pin.FrameType.BODY)]
        along = held_directions(leg.model, leg.description, link, leg.plane)[axis, :3]
        frame.placement = frame.placement * pin.SE3(np.eye(3), step * along)
        groups.append(replace(group, model=replace(group.model, leg=replace(leg, model=model))))
    return replace(problem, groups=tuple(groups))


def row_changes(fitted: Fitted, effects: Effects) -> RowChanges:
    """Find numbers c beside the parameters."""
    # Least squares gives c and its covariance, and ∂β/∂c = −(WᵀW)⁻¹ WᵀD.
    found, count, more = equations(fitted, effects), len(fitted.problem.names), len(effects.prior_std)
    known = found.information[np.ix_(found.free, found.free)]
    inverse = scaled_inverse(known)
    own, slopes_of = np.flatnonzero(found.free[:count]), np.zeros((count, more))
    slopes_of[own] = -scaled_inverse(known[: len(own), : len(own)]) @ found.information[own, count:]
    moved = found.scores[:, found.free] @ inverse[:, -more:]  # sandwich of the scores of blocks
    spread = moved.T @ moved + inverse[-more:] @ np.diag(found.prior[found.free]) @ inverse[:, -more:]
    covariance = inverse[-more:, -more:]
    larger = np.sqrt(np.maximum(1.0, np.diag(covariance) / np.diag(spread)))
    spread = spread * np.outer(larger, larger)
    return RowChanges((inverse @ found.right[found.free])[-more:], covariance, slopes_of, spread, found.blocks)


def equations(fitted: Fitted, effects: Effects) -> Equations:
    """Form the normal equations of the parameters and of numbers beside them, whose columns D are differences."""
    problem, count, more = fitted.problem, len(fitted.problem.names), len(effects.prior_std)
    prior = np.append(np.zeros(count), effects.prior_std**-2.0)
    information, right, squares = np.diag(prior), prior * np.append(np.zeros(count), effects.prior_mean), 0.0
    scores = defaultdict[tuple[str, int, float], FloatArray](lambda: np.zeros(count + more))
    blocks = set[tuple[int, float]]()
    for k, group in enumerate(problem.groups):
        weights = np.array(fitted.fit.weights[slice(*problem.starts[0, k : k + 2])])  # without poses
        values = fitted.values(k)
        for index, one in enumerate(group.motions):
            rows, *changed = (each.decimated(index) for each in (group, *(other.groups[k] for other in effects.others)))
            first = residual(rows, values)
            changed = [rows if len(each.time) != len(first) else each for each in changed]  # at an edge, by rounding
            changes = np.stack([first - residual(each, values) for each in changed], axis=-1) / effects.steps
            # What is scaled is the fitted torque, less its share of r: noise that shrinks would look like a fault
            power = np.sum(changes[..., effects.scales] ** 2, axis=0)
            share = power / np.maximum(power.sum(axis=1, keepdims=True), TINY)
            changes[..., effects.scales] += first[..., None] * share
            both = [np.where(rows.usable[..., None], rows.W, 0.0), changes]
            columns = np.concatenate(both, axis=-1) * weights[:, None]
            alike = np.tile(np.arange(more), (len(first), 1))
            depends = alike if effects.numbers is None else effects.numbers(one, rows.time)
            # rows of all supports of a recording share its blocks of time
            parts = np.column_stack([np.floor(rows.time / BLOCK), depends])
            starts = np.flatnonzero((np.diff(parts, axis=0, prepend=np.nan) != 0.0).any(axis=1)).tolist()
            for start, stop in pairwise([*starts, len(first)]):
                where = np.append(problem.places[k], np.where(depends[start] < 0, -1, count + depends[start]))
                part = columns[start:stop].reshape(-1, len(where))[:, where >= 0]
                where, block = where[where >= 0], float(parts[start, 0])
                information[np.ix_(where, where)] += part.T @ part
                left = (first[start:stop] * weights).ravel()
                score = part.T @ left
                right[where] += score
                squares += float(left @ left)
                scores[one.file_name, len(one), block][where] += score
                blocks.add((id(one), block))
    free = np.isnan(np.append(problem.prior_knowledge.fixed_values(problem.names), np.full(more, np.nan)))
    free[list(fitted.fit.solution.bounded)] = False
    return Equations(information, right, prior, np.array([*scores.values()]), free, squares, len(blocks))


def change_recordings(
    problem: Problem,
    change: Callable[[Group, Recording], Recording],
    parts: Sequence[int] | None = None,
    *,
    torques: bool = False,
) -> Problem:
    """Change the recordings of some groups, of all if None, or torques alone; of many on disk a few remain."""
    groups = list(problem.groups)
    for k in range(len(groups)) if parts is None else parts:
        group = groups[k]
        data = tuple(change(group, one) if isinstance(one, Recording) else one for one in few_of(group.data))
        like = (group, data) if torques and not isinstance(group.data, Recordings) else None
        groups[k] = replace(group, data=data, like=like)
    return replace(problem, groups=tuple(groups))


def residual(rows: Rows, values: FloatArray) -> FloatArray:
    """Residuals of usable rows, (N, R)."""
    return np.where(rows.usable, rows.tau - rows.W @ values, 0.0)


def torque_findings(fitted: Fitted, parts: Sequence[int]) -> Iterator[Finding]:
    """Try other signs and orders of the torques of some groups where the fit is poor; else look for delays."""
    model = fitted.problem.groups[parts[0]].model
    # beside the fault of a single joint, which another sign may look like, signs were tried
    named = any(one.kind in KINDS for one in fitted.findings)
    best = None if named else best_reading(fitted.problem, parts)[0]
    if best is not None:
        text = f"{best.message}: the log fits by far better; interchanged feet, or angles, may look alike"
        yield Finding(best.kind, best.joint, best.value or 1.0, "1", "error", text, best.remedy, parameters=model.names)
        return
    kind = KINDS["torque-delay"]
    for joint, delay, half in zip(model.leg.joint_names, *torque_delays(fitted, parts), strict=True):
        if abs(delay) > (kind.least or 0.0):
            text = f"the torque of {joint} comes {1e3 * abs(delay):.3g} ms {kind.signs[int(delay < 0.0)]}"
            interval = (float(delay - half), float(delay + half))
            yield Finding("torque-delay", joint, float(delay), "s", "warning", text, kind.remedy, interval)


def best_reading(problem: Problem, parts: Sequence[int], rival: Problem | None = None) -> tuple[Reading | None, float]:
    """Reading of the torques that fits by far better than a poor log as it is, and than a rival; log gain of that."""
    plain, *others = readings(problem.groups[parts[0]].model.leg)
    signs = [one for one in others if one.kind != "torque-scale"]  # another scale only parts a torque from the others
    of_torques = [one for one in signs if (one.angles, one.angle_order) == (plain.angles, plain.angle_order)]
    zero, best, rivals = np.zeros(len(problem.names)), None, 0.0
    as_logged, torques = _misfit(problem, parts), rms_residuals(problem, parts, zero)
    if as_logged is None or not (as_logged > 0.25 * POOR * torques)[torques > 0.0].any():
        return None, rivals
    if rival is not None and (misfit := _misfit(rival, parts)) is not None:
        # wrenches that are taken for small ones leave small residuals, too
        level = np.maximum(rms_residuals(rival, parts, zero), TINY) / np.maximum(torques, TINY)
        rivals = float(np.sum(np.log(as_logged / misfit * level)))
    most = max(2.0 * np.log(FITS_BETTER), rivals + 2.0 * np.log(CLEARLY))
    for reading in of_torques:
        misfit = _misfit(problem, parts, reading)
        if misfit is not None and (gain := float(np.sum(np.log(as_logged / misfit)))) > most:
            best, most = reading, gain + 2.0 * np.log(CLEARLY)
    return best, rivals


def _misfit(problem: Problem, parts: Sequence[int], reading: Reading | None = None) -> FloatArray | None:
    """RMS residual of each row of some groups, with torques read otherwise; None where they cannot be fitted."""

    def read(_: Group, one: Recording) -> Recording:
        if reading is None or one.tau is None:
            return one
        return replace(one, tau=one.tau[:, list(reading.torque_order)] * reading.torques)

    # As in the air, all torques with the wrong sign would fit as well if friction could be negative.
    problem = replace(problem, given=replace(problem.given, nonnegative=True))
    try:  # a passive joint has no torque of another
        problem = problem if reading is None else change_recordings(problem, read, parts, torques=True)
        values = wls(problem).solution.values
    except (ExoidError, np.linalg.LinAlgError):
        return None
    if reading is not None and problem.names[0].startswith(("M", "m_")) and values[0] < 0.0:
        return None  # wrenches have the wrong sign, not torques: the whole machine would weigh less than nothing
    return np.maximum(rms_residuals(problem, parts, values), 1e-9)


def rms_residuals(problem: Problem, parts: Sequence[int], values: FloatArray) -> FloatArray:
    """RMS residual of each row of some groups."""
    return np.array([rms_residual(row, values[problem.places[k]]) for k in parts for row in problem.groups[k].by_row])
