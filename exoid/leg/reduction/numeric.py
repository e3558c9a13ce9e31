"""Numerical reduction: base parameters of any robot by QR with column pivoting of its regressor over random motion.

M. Gautier, "Numerical calculation of the base inertial parameters of robots", J. Robotic Systems 8(4), 1991.

A direction x of link parameters counts as one that no motion shows where its effect on the torques ‖Y x‖ is less than
:data:`DISTINCT` times ‖ΔY x‖, its effect through the rounding of the URDF's numbers to four decimals. Rounding itself
yields at most about 1, an offset of 1 mm or an angle of 1 mrad between joint axes 15 or more, and what all robots have
in common a thousand. A threshold at the precision of floating-point numbers instead takes π/2 written as 1.571 for an
angle of its own. It keeps parameters with effects of a millionth of the others, which no recording determines.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import pinocchio as pin
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import NotIdentifiableError
from exoid.leg.closure import Closure, TreeMotion
from exoid.leg.model import position_limits
from exoid.tools.numbers import ROUNDED

from .reduction import LINK_PARAMETERS, LINK_UNITS, Reduction
from .tree import Tree, is_floating
from .tree_regressor import BaseSamples, fill_tree_regressor

ROUNDING = 5e-5
"""Largest error of a number with four decimals: rotations [rad] and positions [m] of joints."""

DRAWS = 4
"""Random roundings; each has as many rows as the regressor."""

DISTINCT = 5.0
"""Smallest effect of a base parameter over that of rounding the URDF's numbers; see above."""

GAP = 2.0
"""Smallest ratio between effects above and below :data:`DISTINCT`, unless the latter are those of exact zeros."""

SHORTEST = 1e3
"""Least scale of a column over the effect of rounding on it: one that is only rounding represents no group."""

REMEDY = "round away tiny offsets and angles between joint axes in the URDF"

PREFERENCE = {"Iyy": 8, "Izz": 8, "Ixx": 7, "mcx": 6, "mcy": 6, "mcz": 6, "Ixy": 5, "Ixz": 5, "Iyz": 5, "m": 0}
"""Preference of the parameter that represents a group: inertias and moments rather than masses."""

LONGEST_NAME = 4
"""Largest number of terms in a parameter's name; :attr:`Reduction.collect` has the whole sum."""


def numeric(
    model: pin.Model,
    labels: Sequence[str],
    *,
    seed: int = 0,
    moving_base: bool = False,
    closure: Closure | None = None,
) -> Reduction:
    """Find the base parameters of a model, each named as a sum such as ``Iyy_shank + 0.185*m_foot``."""
    # Columns are scaled to unit length times a preference, so that pivoting and names are the same on every machine.
    # Parameters that no motion separates are grouped into the first moment or inertia of the link nearest to the base.
    # All geometries have the same independent motion: a pose that only one of them reached would count as rounding.
    moved, base = _random_motion(model, closure, seed)
    regressor = partial(_regressor, moved=moved, base=base if moving_base or is_floating(model) else None)
    W = regressor(model, closure)
    rng = np.random.default_rng(seed)
    changes = [regressor(*_rounded(model, closure, rng)) - W for _ in range(DRAWS)]
    # the length of a column; where that is hardly more than rounding, a length that keeps the column short
    length = np.linalg.norm(W, axis=0)
    shortest = SHORTEST * np.sqrt(np.mean([np.sum(change**2, axis=0) for change in changes], axis=0))
    scale = np.maximum(np.maximum(length, shortest), ROUNDED * length.max())
    nonzero = np.flatnonzero(length > ROUNDED * scale.max())
    unit = W[:, nonzero] / scale[nonzero]
    changed = [change[:, nonzero] / scale[nonzero] for change in changes]
    r = _decide_rank(unit, changed, closed=closure is not None)
    _, R, order = scipy.linalg.qr(unit * _preferences(nonzero, W.shape[1]), mode="economic", pivoting=True)
    kept, grouped = nonzero[order[:r]], nonzero[order[r:]]
    weights = np.zeros((r, W.shape[1]))
    if len(grouped):
        unit_of = scale / _preferences(np.arange(W.shape[1]), W.shape[1])
        ratio = scipy.linalg.solve_triangular(R[:r, :r], R[:r, r:]) * unit_of[grouped] / unit_of[kept][:, None]
        weights[:, grouped] = np.where(np.abs(ratio) > ROUNDED, ratio, 0.0)
    weights[np.arange(r), kept] = 1.0
    ascending = np.argsort(kept)
    kept, weights = kept[ascending], weights[ascending]
    spread = np.zeros((W.shape[1], r))
    spread[kept, np.arange(r)] = 1.0
    mentioned = weights.copy()
    rounded = _rounded_coefficients(W / scale, [change / scale for change in changes], kept, grouped)
    small = np.abs(weights[:, grouped]) < DISTINCT * rounded * scale[grouped] / scale[kept][:, None]
    mentioned[:, grouped] = np.where(small, 0.0, weights[:, grouped])
    names = tuple(_label(row, int(k), labels) for row, k in zip(mentioned, kept, strict=True))
    return Reduction(names, tuple(LINK_UNITS[k % 10] for k in kept), weights, spread)


def _random_motion(model: pin.Model, closure: Closure | None, seed: int) -> tuple[TreeMotion, BaseSamples]:
    """Draw a motion of the independent joints within their limits, at which loops close, and one of the base."""
    rng = np.random.default_rng(seed)
    samples, size = 15 * model.nv + 20, 1.0 if closure is None else closure.sizes
    joints, widest = slice(None) if closure is None else closure.independent, np.pi * size * np.array([[-1.0], [1.0]])
    limits = np.clip(position_limits(model)[:, joints], *widest)
    low, high = np.where(limits[0] < limits[1], limits, widest)
    q = rng.uniform(low, high, (samples, len(low)))
    v, a = size * rng.uniform(-3, 3, (2, *q.shape))
    velocity, acceleration = np.zeros((samples, 6)), rng.uniform(-9, 9, (samples, 6))
    velocity[:, 3:] = rng.uniform(-3, 3, (samples, 3))
    if closure is not None:
        q, _ = closure.solve(closure.reachable(q))
    return TreeMotion(q, v, 3.0 * a), BaseSamples(velocity, acceleration)


def _regressor(model: pin.Model, closure: Closure | None, moved: TreeMotion, base: BaseSamples | None) -> FloatArray:
    if closure is not None:
        moved = closure.rates(closure.correct(moved.q), moved.v, moved.a)
    tree = Tree.from_model(model)
    columns = np.zeros((10 * tree.bodies, tree.rows, len(moved.q)))
    fill_tree_regressor(tree, moved.q, moved.v, moved.a, range(len(columns)), columns, base)
    if moved.G is not None:
        columns = np.einsum("ktb,tib->kib", columns, moved.G)
    return columns.transpose(2, 1, 0).reshape(-1, len(columns))


def _rounded(model: pin.Model, closure: Closure | None, rng: np.random.Generator) -> tuple[pin.Model, Closure | None]:
    """Copy a model, and the loops that close it, with random rounding errors of the places of joints and points."""
    copy = pin.Model(model)
    for j in range(1, copy.njoints):
        rotation, translation = rng.uniform(-ROUNDING, ROUNDING, (2, 3))
        copy.jointPlacements[j] = copy.jointPlacements[j] * pin.SE3(pin.exp3(rotation), translation)
    if closure is None:
        return copy, None
    pairs = (each._replace(places=each.places + rng.uniform(-ROUNDING, ROUNDING, (2, 3))) for each in closure.pairs)
    return copy, replace(closure, model=copy, pairs=tuple(pairs))


def _decide_rank(unit: FloatArray, changes: Sequence[FloatArray], *, closed: bool) -> int:
    """Count the directions with effects beyond those of rounding: generalised singular values of Y and ΔY."""
    floor = ROUNDED * np.eye(unit.shape[1])  # directions that no rounding changes
    R = np.asarray(np.linalg.qr(unit, mode="r"))
    stacked = np.vstack([*(change / np.sqrt(len(changes)) for change in changes), floor])
    rounded = np.asarray(np.linalg.qr(stacked, mode="r"))
    effects = np.linalg.svd(scipy.linalg.solve_triangular(rounded, R.T, trans="T").T, compute_uv=False)
    rank = int((effects > DISTINCT).sum())
    # The short strokes of closed loops make effects that fade out evenly: those above the next gap are kept, too
    while closed and 0 < rank < len(effects) and effects[rank] * GAP > effects[rank - 1]:
        rank += 1
    if rank < len(effects) and effects[rank] * GAP > effects[rank - 1]:
        raise NotIdentifiableError(
            f"the number of base parameters is ambiguous: one has {effects[rank - 1]:.1f} times the effect of rounding "
            f"the URDF's numbers by {ROUNDING:g}, another {effects[rank]:.1f} times, and {DISTINCT:g} times is kept",
            remedy=REMEDY,
        )
    return rank


def _rounded_coefficients(
    unit: FloatArray, changes: Sequence[FloatArray], kept: NDArray[np.intp], grouped: NDArray[np.intp]
) -> FloatArray:
    """Change of the coefficients of grouped columns by rounding, root mean square, (p, number grouped)."""
    exact, *found = [
        np.linalg.lstsq(each[:, kept], each[:, grouped])[0] for each in (unit, *(unit + change for change in changes))
    ]
    return np.asarray(np.sqrt(np.mean([(one - exact) ** 2 for one in found], axis=0)))


def _preferences(columns: FloatArray | np.ndarray, total: int) -> FloatArray:
    """Weights in (0, 1] that order equivalent columns: by kind of parameter, then from the base outwards."""
    kind = np.array([PREFERENCE[LINK_PARAMETERS[k % 10]] for k in columns])
    return np.asarray((1.0 + kind) / 9.0 * (1.0 - 0.1 * np.asarray(columns) / total))


def _label(row: FloatArray, first: int, labels: Sequence[str]) -> str:
    terms = [first, *(int(k) for k in np.flatnonzero(row) if k != first)]
    text = ""
    for k in terms[:LONGEST_NAME]:
        name = f"{LINK_PARAMETERS[k % 10]}_{labels[k // 10]}"
        size = f"{abs(row[k]):.3g}"
        sign = " - " if row[k] < 0 else " + "
        text += (sign if text else "") + (name if size == "1" else f"{size}*{name}")
    return text if len(terms) <= LONGEST_NAME else f"{text} + …"
