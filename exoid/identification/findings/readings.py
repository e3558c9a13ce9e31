"""Gross faults: does the log fit by far better with other signs, orders or units?"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate.finding import Finding
from exoid.leg.leg import Leg
from exoid.torques.catalog import radians, turning_joints

from .efforts import CLEARLY, FITS_BETTER, driven_joints, fit_torques, torque_factors, torque_rows
from .evidence import Evidence, r_factor
from .sample import FittedLeg, log_starts, some_samples

STILL = 0.05  # span of a joint that hardly moves [rad]


class Reading(NamedTuple):
    """Another reading of a log: factors of the logged values, and the index of the logged value of each joint."""

    kind: str  # kind of the finding
    joint: str  # joints that it concerns; "" for all
    message: str  # meaning
    remedy: str  # advice
    angles: tuple[float, ...]  # factor of each angle, (n,)
    torques: tuple[float, ...]  # factor of each torque, (n,)
    angle_order: tuple[int, ...]  # index of the logged angle of each joint, (n,)
    torque_order: tuple[int, ...]  # index of the logged torque of each joint, (n,)
    value: float = 0.0  # factor of the logged values; 0 to report how many times smaller residuals become


def readings(leg: Leg) -> Iterator[Reading]:
    """List readings of a log, the log as it is first, the likely before the far-fetched."""
    names, n = leg.joint_names, len(leg.joint_names)
    plain = Reading("", "", "", "", (1.0,) * n, (1.0,) * n, tuple(range(n)), tuple(range(n)))
    yield plain

    def only(joints: Sequence[int], factor: float) -> tuple[float, ...]:
        return tuple(factor if k in joints else 1.0 for k in range(n))

    twins = _twins(names)
    each = (*((j,) for j in range(n)), *twins)
    several = [(one, ", ".join(names[j] for j in one), " and ".join(names[j] for j in one)) for one in each]
    sign = plain._replace(kind="torque-sign", remedy="negate the column where the log is read", value=-1.0)
    for joints, joint, both in several:
        text = f"the torque of {both} has the wrong sign"
        if joints == (0,):  # a leg that is its own mirror image
            text = f"{text}, or its angle has"
        yield sign._replace(joint=joint, message=text, torques=only(joints, -1.0))
    milli = plain._replace(kind="torque-scale", value=1e3, remedy="convert it to N·m (tau_<joint>=HEADER:0.001)")
    yield milli._replace(message="all torques are in N·mm", torques=(1e-3,) * n)
    if n > 1:
        yield sign._replace(message="all torques have the wrong sign, or all angles have", torques=(-1.0,) * n)
        for joints, joint, both in several:
            turned = sign._replace(kind="angle-sign", joint=joint, angles=only(joints, -1.0))
            yield turned._replace(message=f"the angle of {both} has the wrong sign, or its axis in the URDF has")
            text = f"angle and torque of {both} have the wrong sign, or its axis in the URDF has"
            yield turned._replace(message=text, torques=only(joints, -1.0))
        for j, joint in enumerate(names):
            yield milli._replace(joint=joint, message=f"the torque of {joint} is in N·mm", torques=only([j], 1e-3))
    remedy = "map the columns by name (columns=, --column NAME=HEADER)"
    for i, k in combinations(range(n), 2):
        swapped = tuple(k if j == i else i if j == k else j for j in range(n))
        both = f"{names[i]} and {names[k]}"
        swap = plain._replace(kind="joint-order", joint=f"{names[i]}, {names[k]}", remedy=remedy)
        yield swap._replace(message=f"the torques of {both} are swapped", torque_order=swapped)
        if n > 4 and k > i + 1:  # other angles need all rows anew: of many joints, only neighbours
            continue
        yield swap._replace(message=f"the angles of {both} are swapped", angle_order=swapped)
        yield swap._replace(message=f"{both} are swapped", angle_order=swapped, torque_order=swapped)
    if len(twins) > 1:
        other = dict([*twins, *(pair[::-1] for pair in twins)])
        text, order = "the torques of left and right are interchanged", tuple(other.get(j, j) for j in range(n))
        yield plain._replace(kind="joint-order", message=text, remedy=remedy, torque_order=order)
    unit, remedy = float(np.pi / 180.0), 'read the log with angle_unit="deg" (--degrees), or convert the column'
    degrees = plain._replace(kind="angle-scale", remedy=remedy, value=1.0 / unit)
    turning = np.flatnonzero(turning_joints(leg)).tolist()
    if turning:
        yield degrees._replace(message="all angles are degrees", angles=only(turning, unit))
    for j, joint in ((j, names[j]) for j in turning if n > 1):
        yield degrees._replace(joint=joint, message=f"the angle of {joint} is in degrees", angles=only([j], unit))


def _twins(names: Sequence[str]) -> list[tuple[int, int]]:
    """Joints on the left with those of the same name on the right."""
    for left, right in (("left", "right"), ("L", "R"), ("l_", "r_"), ("_l", "_r")):
        others = [(name.replace(right, left, 1), k) for k, name in enumerate(names) if right in name]
        if found := [(names.index(other), k) for other, k in others if other in names]:
            return found
    return []


def gross_findings(fitted: FittedLeg, evidence: Evidence, *, angles: bool) -> tuple[Finding, ...]:
    """Try other signs, orders of joints and units, also of angles; report the one that fits by far better."""
    trial = fitted._replace(data=some_samples(fitted.model, fitted.data, 12_000))  # gross faults show in few
    try:
        formed = (r_factor(torque_rows(evidence, j)) for j in range(len(evidence.factors)))
        as_logged = torque_factors(trial, trial.data) if angles else [*formed]
        left, _ = fit_torques(trial, as_logged)
        best, least, log = *_best_reading(trial, as_logged, float(left.mean()), angles=angles), ""
        if angles:
            of_one = _of_one_log(trial, as_logged, float(left.mean()))
            best, least, log = of_one if of_one[1] < least else (best, least, log)
    except (ExoidError, np.linalg.LinAlgError):
        return ()
    if best is None:
        return ()
    ratio = float(np.exp(left.mean() - least) / CLEARLY ** _share_of_two(as_logged))
    message, value = f"{best.message}: residuals are then {ratio:.3g} times smaller", best.value or ratio
    names = fitted.model.names
    return (Finding(best.kind, best.joint, value, "1", "error", message, best.remedy, None, names, recording=log),)


def _of_one_log(
    fitted: FittedLeg, as_logged: Sequence[FloatArray], reference: float
) -> tuple[Reading | None, float, str]:
    """Reading of one of several logs, the others as they are, that fits by far better; and the name of that log."""
    always = np.array([-np.inf, np.inf])  # poses have no time, and are a log of their own
    names, times = [one.file_name for one in fitted.data], [getattr(one, "time", always) for one in fitted.data]
    numbers = np.cumsum(log_starts(names, times)).tolist()
    logs = {number: [one for one, k in zip(fitted.data, numbers, strict=True) if k == number] for number in numbers}
    every = {number: torque_factors(fitted, log) for number, log in logs.items() if len(logs) > 1}
    best, least, where, share = None, np.inf, "", _share_of_two(as_logged)
    for number, own in every.items():
        others = [of_log for k, of_log in every.items() if k != number]
        rest = [r_factor(np.vstack(of_joint)) for of_joint in zip(*others, strict=True)]
        if fit_torques(fitted, rest)[0].mean() > reference - share * np.log(FITS_BETTER):
            continue  # the others do not agree without it, either
        only = fitted._replace(data=logs[number])
        found, misfit = _best_reading(only, own, reference, rest, angles=True)
        if found is not None and misfit < least:
            best, least, where = found, misfit, logs[number][0].file_name or f"recording {number}"
    return best, float(least), where


def _best_reading(
    fitted: FittedLeg,
    as_logged: list[FloatArray],
    reference: float,
    rest: Sequence[FloatArray] = (),
    *,
    angles: bool,
) -> tuple[Reading | None, float]:
    """Reading that fits by far better, if any, and the misfit that another one would have to fall below."""
    # rows of other logs, which are read as they are, go into each fit
    rest = rest or [R[:0] for R in as_logged]

    def misfits(factors: Sequence[FloatArray], reading: Reading, rounds: int = 3) -> FloatArray:
        """Logarithms of residual over torque of each joint."""
        parted = [np.split(R, [R.shape[1] - len(factors)], axis=1) for R in factors]
        read = [np.hstack([W, tau[:, reading.torque_order] * reading.torques]) for W, tau in parted]
        both = [r_factor(np.vstack(of_joint)) for of_joint in zip(read, rest, strict=True)]
        return fit_torques(fitted, both, rounds=rounds)[0]

    plain, *others = readings(fitted.model.leg)
    driven, share = driven_joints(as_logged), _share_of_two(as_logged)
    best, least = None, reference - share * np.log(FITS_BETTER)
    spans = np.max([np.ptp(one.q, axis=0) for one in fitted.data], axis=0) / radians(fitted.model.leg)
    names = fitted.model.leg.joint_names
    still = {name for name, span in zip(names, spans, strict=True) if span < STILL}
    passive = {name for name, is_driven in zip(names, driven, strict=True) if not is_driven}
    logged = kinematics = plain.angles, plain.angle_order
    few = torque_factors(fitted, fitted.data, few=True) if angles else as_logged
    first, of_few = (misfits(each, plain, rounds=1).mean() for each in (as_logged, few))
    for reading in others:
        joints = set(reading.joint.split(", "))
        moved = {joint for joint, (j, k) in zip(names, enumerate(reading.torque_order), strict=True) if j != k}
        if joints & still or moved & passive:
            continue
        if reading.kind == "angle-scale" and (spans * reading.angles)[np.array(reading.angles) != 1.0].max() < STILL:
            continue  # so little a motion in degrees identifies nothing
        if not angles and (reading.angles, reading.angle_order) != logged:
            continue
        before, kinematics = kinematics, (reading.angles, reading.angle_order)
        if kinematics == logged:
            few, factors, most = as_logged, as_logged, first
        elif kinematics != before:  # rows of the reading before may be the same
            order, signs = list(reading.angle_order), np.array(reading.angles)
            pairs = [(one, {name: getattr(one, name, None) for name in ("q", "v", "a")}) for one in fitted.data]
            read = ((one, {name: x[:, order] * signs for name, x in of.items() if x is not None}) for one, of in pairs)
            data = [replace(one, **changed) for one, changed in read]
            few, factors, most = torque_factors(fitted, data, few=True), [], of_few + share * np.log(FITS_BETTER)
        if misfits(few, reading, rounds=1).mean() > most:
            continue  # other weights, or the rest of the log, would not bring it so far
        factors = factors or torque_factors(fitted, data)
        left = misfits(factors, reading)
        if reading.kind == "torque-scale" and left.max() > np.log(0.5):
            continue  # a torque that hardly weighs lets the others contradict it
        # of a passive joint only the torques of others speak: they have to be three times clearer
        silent = reading.kind == "joint-order" and joints & passive
        misfit = float(left.mean()) + (share * np.log(3.0) if silent else 0.0)
        if misfit < least:
            best, least = reading, misfit - share * np.log(CLEARLY)
    return best, float(least)


def _share_of_two(factors: Sequence[FloatArray]) -> float:
    """Part that two joints have in a mean over all driven ones."""
    return min(1.0, 2.0 / max(sum(driven_joints(factors)), 1))
