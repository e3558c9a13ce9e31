"""A tree of joints, with closed loops or without, as tables for the template ``tree.c.jinja``."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.leg import closure
from exoid.leg.leg import Leg
from exoid.leg.leg_data import refuse_floating_base
from exoid.leg.model import joint_axis

from .dialect import Dialect
from .law_in_c import ArrayInC


class TreeInC(NamedTuple):
    """Rigid bodies of a leg that is no planar chain."""

    joints: int  # number of joints, dependent ones included
    arrays: tuple[ArrayInC, ...]
    dependent: int  # number of joints that follow from the loops
    points: int  # number of pairs of points that the loops hold together
    sign: float  # sign of the determinant on the branch of the reference
    converged: float  # last correction that ends Newton's method [rad or m]
    step: float = closure.STEP
    corrections: int = closure.CORRECTIONS
    farthest: float = 20.0  # distance from the closed pose at which none is looked for [rad or m]: it bounds the time


def tree_in_c(leg: Leg, values: FloatArray, dialect: Dialect) -> TreeInC | None:
    """Write the joints and bodies of a leg, whose parameters have these values; None for a planar chain."""
    refuse_floating_base(leg, "code of a leg")
    if leg.chain is not None:
        return None
    model, loops = leg.model, leg.closure
    places = [model.jointPlacements[j] for j in range(1, model.njoints)]
    axes = np.array([joint_axis(model.joints[j]) for j in range(1, model.njoints)])
    turns = np.any(axes[:, 3:], axis=1)
    bodies = (leg.reduction.spread @ values).reshape(-1, 10)
    arrays = [
        ArrayInC("up", "gravity, upwards [m/s^2]", -model.gravity.linear),
        ArrayInC("parent", f"parent of each joint: {', '.join(leg.tree_joint_names)}", np.array(model.parents[1:])),
        ArrayInC("turns", "1 where the joint turns, 0 where it slides", turns.astype(int)),
        ArrayInC("axis", "axis of each joint", np.where(turns[:, None], axes[:, 3:], axes[:, :3])),
        ArrayInC("origin", "origin of each joint in its parent [m]", np.array([at.translation for at in places])),
        ArrayInC("orientation", "axes of each joint in its parent", np.array([at.rotation.ravel() for at in places])),
        ArrayInC("bodies", "m, m c, and I about the joint; base parameters, zeros for what torques hide", bodies),
    ]
    if loops is None:
        return TreeInC(len(places), tuple(arrays), 0, 0, 0.0, 0.0)
    pairs = loops.pairs
    moves = np.zeros((len(pairs), len(places)), dtype=int)
    for k, pair in enumerate(pairs):
        first, second = ([*model.supports[body + 1]] for body in pair.bodies)
        moves[k] = [(j in second) - (j in first) for j in range(1, model.njoints)]
    arrays += [
        ArrayInC("ends", "bodies of the two ends of each loop", np.array([pair.bodies for pair in pairs]) + 1),
        ArrayInC("points", "their points [m]", np.array([pair.places for pair in pairs])),
        ArrayInC("moves", "1 where a joint moves the second end, -1 the first", moves),
        ArrayInC("rows", "combinations of the gaps that are independent", loops.rows),
        ArrayInC("reference", "closed pose", loops.reference),
        ArrayInC("independent", "joints of the leg", loops.independent),
        ArrayInC("dependent", "joints that follow from them", loops.dependent),
    ]
    # Single precision ends one step of Newton's method earlier: the error is the square of the last correction
    converged = closure.CONVERGED if dialect.real == "double" else 1e-4
    return TreeInC(len(places), tuple(arrays), len(loops.dependent), len(pairs), loops.sign, converged)
