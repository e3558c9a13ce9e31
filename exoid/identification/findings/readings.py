"""Gross faults: does the log fit by far better with other signs, another order of joints, or angles in degrees?"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from exoid.errors import ExoidError
from exoid.estimate.finding import Finding
from exoid.signals import Poses, Recording

from .coupled import coupled_joints, coupling_finding, pairs_of
from .factors import TorqueFactors
from .sample import FittedLeg

CLEARLY = 1.1
"""A reading that is more far-fetched than another has to fit so many times better."""


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

    def angles_of(self, one: Recording | Poses) -> Recording | Poses:
        """Read the angles of a recording otherwise."""
        order, factors = list(self.angle_order), np.array(self.angles)
        every = ("q",) if isinstance(one, Poses) else ("q", "v", "a")
        changed = {name: x[:, order] * factors for name in every if (x := getattr(one, name)) is not None}
        return replace(one, **changed)


def readings(names: Sequence[str]) -> Iterator[Reading]:
    """List readings of a log, the log as it is first, the likely before the far-fetched."""
    n = len(names)
    plain = Reading("", "", "", "", (1.0,) * n, (1.0,) * n, tuple(range(n)), tuple(range(n)))
    yield plain

    def only(j: int, factor: float) -> tuple[float, ...]:
        return tuple(factor if k == j else 1.0 for k in range(n))

    sign = plain._replace(kind="torque-sign", remedy="negate the column where the log is read", value=-1.0)
    for j, joint in enumerate(names):
        text = f"the torque of {joint} has the wrong sign"
        if j == 0:  # a leg that is its own mirror image
            text = f"{text}, or its angle has"
        yield sign._replace(joint=joint, message=text, torques=only(j, -1.0))
    if n > 1:
        yield sign._replace(message="all torques have the wrong sign, or all angles have", torques=(-1.0,) * n)
        for j, joint in enumerate(names):
            turned = sign._replace(kind="angle-sign", joint=joint, angles=only(j, -1.0))
            yield turned._replace(message=f"the angle of {joint} has the wrong sign, or its axis in the URDF has")
            text = f"angle and torque of {joint} have the wrong sign, or its axis in the URDF has"
            yield turned._replace(message=text, torques=only(j, -1.0))
    for i, k in pairs_of(n):
        swapped = tuple(k if j == i else i if j == k else j for j in range(n))
        both, remedy = f"{names[i]} and {names[k]}", "map the columns by name (columns=, --column NAME=HEADER)"
        swap = plain._replace(kind="joint-order", joint=f"{names[i]}, {names[k]}", remedy=remedy)
        yield swap._replace(message=f"the torques of {both} are swapped", torque_order=swapped)
        yield swap._replace(message=f"the angles of {both} are swapped", angle_order=swapped)
        yield swap._replace(message=f"{both} are swapped", angle_order=swapped, torque_order=swapped)
    unit, remedy = float(np.pi / 180.0), 'read the log with angle_unit="deg" (--degrees), or convert the column'
    degrees = plain._replace(kind="angle-scale", remedy=remedy, value=1.0 / unit)
    yield degrees._replace(message="all angles are degrees", angles=(unit,) * n)
    for j, joint in enumerate(names if n > 1 else ()):
        yield degrees._replace(joint=joint, message=f"the angle of {joint} is in degrees", angles=only(j, unit))


def gross_findings(fitted: FittedLeg) -> tuple[Finding, ...]:
    """Try other signs, orders of joints and units, and coupled motors; report the one that fits by far better."""
    model, trial = fitted.model, fitted._replace(data=_shortened(fitted.data))
    try:
        as_logged = TorqueFactors.of(trial, trial.data)
        reference = as_logged.fit(trial).misfit
        best, least = _best_reading(trial, as_logged, reference)
        loaded = any(isinstance(one, Recording) and one.loaded_links for one in trial.data)
        coupled = None if loaded else coupled_joints(trial, as_logged, reference)  # errors of a force mix torques too
    except (ExoidError, np.linalg.LinAlgError):
        return ()
    # Coupled joints have numbers of their own to fit, and have to fit half as well again.
    if coupled is not None and coupled.misfit < least - np.log(1.5):
        return (coupling_finding(model, coupled, reference),)
    if best is None:
        return ()
    ratio = float(np.exp(reference - least) / CLEARLY)
    message, value = f"{best.message}: residuals are then {ratio:.3g} times smaller", best.value or ratio
    return (Finding(best.kind, best.joint, value, "1", "error", message, best.remedy, parameters=model.names),)


def _best_reading(fitted: FittedLeg, as_logged: TorqueFactors, reference: float) -> tuple[Reading | None, float]:
    """Reading that fits by far better, if any, and the misfit that another one would have to fall below."""
    plain, *others = readings(fitted.model.joint_names)
    best, least = None, reference - np.log(1.6)  # residuals over torques 1.6 times smaller (geometric mean)
    for reading in others:
        moved = [(j, k) for j, k in enumerate(reading.torque_order) if j != k]
        if not all(as_logged.driven[j] and as_logged.driven[k] for j, k in moved):
            continue
        factors = as_logged
        if (reading.angles, reading.angle_order) != (plain.angles, plain.angle_order):
            factors = TorqueFactors.of(fitted, [reading.angles_of(one) for one in fitted.data])
        misfit = factors.fit(fitted, reading.torque_order, reading.torques).misfit
        if misfit < least:
            best, least = reading, misfit - np.log(CLEARLY)
    return best, float(least)


def _shortened(data: Sequence[Recording | Poses]) -> tuple[Recording | Poses, ...]:
    """Take the first recordings, up to 12 000 samples: gross faults show in few."""
    kept: list[Recording | Poses] = []
    left = enough = 12_000
    for one in data:
        if left <= 0:
            break
        cut = len(one) > left and isinstance(one, Recording) and one.mask is None and left >= enough // 4
        kept.append(one.slice(0, left) if cut and isinstance(one, Recording) else one)
        left -= len(one)
    return tuple(kept)
