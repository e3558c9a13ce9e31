"""Gross faults: does the log fit by far better with other signs, another order of joints, or angles in degrees?"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate.finding import Finding
from exoid.signals import Poses, Recording
from exoid.torques import TorqueModel

from .coupled import coupled_joints, coupling_finding
from .factors import TorqueFactors, never_negative
from .sample import Checked

POOR = 0.2
"""Alternatives are worth trying where the NRMSE of a joint is above this,"""

NEGATIVE, MATTERS = -4.5, 0.02
"""or where a parameter that cannot be negative is, by so many standard deviations, and by this part of the torque."""

BETTER = 1.6
"""An alternative is accepted if residuals, relative to the torque, are so many times smaller (geometric mean),"""

CLEARLY = 1.1
"""and one that is more far-fetched only if they are so many times smaller still."""

CLEARLY_MIXED = 1.5
"""Coupled joints, which have numbers of their own to fit, are reported only if they fit so many times better still."""

ENOUGH = 12_000
"""Samples that are looked at, at most."""

SWAPPED_JOINTS = 4
"""Up to so many joints all pairs are swapped, beyond only neighbours."""


class Alternative(NamedTuple):
    """Another reading of a log."""

    kind: str  # kind of the finding
    joint: str  # joints that it concerns; "" for all
    angles: tuple[float, ...]  # factor of each angle, (n,)
    angle_order: tuple[int, ...]  # index of the logged angle of each joint, (n,)
    torques: tuple[float, ...]  # factor of each torque, (n,)
    torque_order: tuple[int, ...]  # index of the logged torque of each joint, (n,)
    message: str  # meaning
    remedy: str  # advice
    value: float = 0.0  # factor of the logged values; 0 to report how many times smaller residuals become


def negative_parameters(
    model: TorqueModel, values: FloatArray, std: FloatArray, shares: FloatArray
) -> NDArray[np.bool_]:
    """Which parameters are negative although they cannot be, by more than their errors, and matter."""
    below = (values < NEGATIVE * std) & (values < 0.0) & (shares > MATTERS)
    return np.asarray(below & never_negative(model))


def gross_findings(checked: Checked) -> tuple[Finding, ...]:
    """Try other signs, orders of joints and units, and report the one that fits by far better."""
    # Friction, rotor inertia and the J of planar segments are kept from being negative: all torques with the wrong sign
    # would fit as well otherwise.
    model = checked.model
    trial = checked._replace(data=tuple(_shortened(checked.data)))
    base = tuple(alternatives(model))
    try:
        as_logged = TorqueFactors.of(trial, trial.data)
        reference = as_logged.fit(checked).misfit
        best, least = base[0], reference - np.log(BETTER)
        for alternative in (one for one in base[1:] if _moves_driven(one, as_logged.driven)):
            same_angles = alternative.angles == base[0].angles and alternative.angle_order == base[0].angle_order
            data = (_reread(one, alternative) for one in trial.data)
            factors = as_logged if same_angles else TorqueFactors.of(trial, data)
            misfit = factors.fit(checked, alternative.torque_order, alternative.torques).misfit
            if misfit < least:
                best, least = alternative, misfit - np.log(CLEARLY)
        loaded = any(isinstance(one, Recording) and one.loaded_links for one in trial.data)
        coupled = None if loaded else coupled_joints(trial, as_logged, reference)  # errors of a force mix torques too
    except (ExoidError, np.linalg.LinAlgError):
        return ()
    if coupled is not None and coupled.misfit < least - np.log(CLEARLY_MIXED):
        return (coupling_finding(checked, coupled, reference),)
    if best is base[0]:
        return ()
    ratio = float(np.exp(reference - least - np.log(CLEARLY)))
    message = f"{best.message}: residuals are then {ratio:.3g} times smaller"
    return (
        Finding(best.kind, best.joint, best.value or ratio, "1", "error", message, best.remedy, parameters=model.names),
    )


def _moves_driven(alternative: Alternative, driven: Sequence[bool]) -> bool:
    """Whether a reading takes torques only from and to joints that have one."""
    return all(driven[j] and driven[k] for j, k in enumerate(alternative.torque_order) if j != k)


def alternatives(model: TorqueModel) -> Iterator[Alternative]:
    """List readings of a log, the log as it is first, the likely before the far-fetched."""
    names, n = model.joint_names, len(model.joint_names)
    ones, order = (1.0,) * n, tuple(range(n))
    yield Alternative("", "", ones, order, ones, order, "", "")
    flipped = tuple(tuple(-1.0 if k == j else 1.0 for k in range(n)) for j in range(n))
    turn = "negate the column where the log is read"
    for j, joint in enumerate(names):
        text = f"the torque of {joint} has the wrong sign"
        if j == 0:  # a leg that is its own mirror image
            text = f"the torque of {joint} has the wrong sign, or its angle has"
        yield Alternative("torque-sign", joint, ones, order, flipped[j], order, text, turn, -1.0)
    if n > 1:
        text = "all torques have the wrong sign, or all angles have"
        yield Alternative("torque-sign", "", ones, order, (-1.0,) * n, order, text, turn, -1.0)
        for j, joint in enumerate(names):
            text = f"the angle of {joint} has the wrong sign, or its axis in the URDF has"
            yield Alternative("angle-sign", joint, flipped[j], order, ones, order, text, turn, -1.0)
            text = f"angle and torque of {joint} have the wrong sign, or its axis in the URDF has"
            yield Alternative("angle-sign", joint, flipped[j], order, flipped[j], order, text, turn, -1.0)
    pairs = combinations(range(n), 2) if n <= SWAPPED_JOINTS else ((j, j + 1) for j in range(n - 1))
    map_columns = "map the columns by name (columns=, --column NAME=HEADER)"
    for i, k in pairs:
        swapped = tuple(k if j == i else i if j == k else j for j in range(n))
        both = f"{names[i]}, {names[k]}"
        text = f"the torques of {names[i]} and {names[k]} are swapped"
        yield Alternative("joint-order", both, ones, order, ones, swapped, text, map_columns)
        text = f"the angles of {names[i]} and {names[k]} are swapped"
        yield Alternative("joint-order", both, ones, swapped, ones, order, text, map_columns)
        text = f"{names[i]} and {names[k]} are swapped"
        yield Alternative("joint-order", both, ones, swapped, ones, swapped, text, map_columns)
    unit = float(np.pi / 180.0)
    in_degrees = 'read the log with angle_unit="deg" (--degrees), or convert the column'
    yield Alternative(
        "angle-scale", "", (unit,) * n, order, ones, order, "all angles are degrees", in_degrees, 1.0 / unit
    )
    for j, joint in enumerate(names if n > 1 else ()):
        factors = tuple(unit if k == j else 1.0 for k in range(n))
        text = f"the angle of {joint} is in degrees"
        yield Alternative("angle-scale", joint, factors, order, ones, order, text, in_degrees, 1.0 / unit)


def _shortened(data: Sequence[Recording | Poses]) -> Iterator[Recording | Poses]:
    """Take the first recordings, up to so many samples."""
    left = ENOUGH
    for one in data:
        if left <= 0:
            return
        if len(one) > left and isinstance(one, Recording) and one.mask is None and left >= ENOUGH // 4:
            yield one.slice(0, left)
        else:
            yield one
        left -= len(one)


def _reread(one: Recording | Poses, alternative: Alternative) -> Recording | Poses:
    """Read the angles of a recording otherwise."""
    order, factors = list(alternative.angle_order), np.array(alternative.angles)
    if order == sorted(order) and (factors == 1.0).all():
        return one
    if isinstance(one, Poses):
        return replace(one, q=one.q[:, order] * factors)
    v = None if one.v is None else one.v[:, order] * factors
    a = None if one.a is None else one.a[:, order] * factors
    return replace(one, q=one.q[:, order] * factors, v=v, a=a)
