r"""Columns of Pinocchio's regressor for any tree of joints, batched over samples.

All vectors of a body are in the axes of its joint frame. Let s = (u, w) be the motion vector that a unit rate of joint
k gives to the frame of body j: linear u and angular w. Let ω and α be the angular velocity and acceleration of the
body, and a the acceleration of its frame's origin less gravity. With the parameters (m, mc, I) of body j alone, the
torque of each joint k that carries it is

    τ_k = u · [m a + α × mc + ω × (ω × mc)] + w · [mc × a + I α + ω × I ω]

(Khalil and Dombre 2002, ch. 9; Featherstone 2008, ch. 5). Velocity, acceleration and every s go from body to body by
one matrix product and one rotation. The interpreter works once for each body and block, and not for each sample.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.leg.closure import BLOCK

from .reduction import Reduction
from .tree import BASE_ROWS, Tree, TreeJoint
from .tree_motion import CYCLIC, carry, turn_back

VELOCITY, ACCELERATION, AXES = 0, 1, 2
"""Places among the motion vectors of a body; behind them are the axes of the joints that carry it."""

INERTIAS = {4: (0, 0), 5: (0, 1), 6: (1, 1), 7: (2, 0), 8: (1, 2), 9: (2, 2)}
"""Axes of Ixx, Ixy, Iyy, Ixz, Iyz, Izz by their place among a body's ten parameters, in cyclic order."""


class BaseSamples(NamedTuple):
    """Motion of the base at N samples, in its own axes."""

    velocity: FloatArray  # spatial velocity, linear [m/s] before angular [rad/s], (N, 6)
    # spatial acceleration less gravity, linear [m/s²] before angular [rad/s²], (N, 6). Where the linear
    # velocity is zero, its linear part is the specific force that an accelerometer at the origin measures
    acceleration: FloatArray


def fill_tree_regressor(
    tree: Tree,
    q: FloatArray,
    v: FloatArray,
    a: FloatArray,
    columns: Sequence[int] | NDArray[np.intp],
    out: FloatArray,
    base: BaseSamples | None = None,
) -> None:
    """Write columns of Pinocchio's regressor for every sample."""
    layouts = [_Layout.of(tree, body, columns) for body in range(tree.bodies)]
    vectors = sum(AXES + len(joint.carriers) for joint in tree.joints)
    # Samples computed at once are fewer than `BLOCK` where the motion of all bodies takes more memory than this
    block = max(1, min(BLOCK, (2**25) // (8 * 6 * max(vectors, 1)), len(q)))
    for start in range(0, len(q), block):
        rows = slice(start, start + block)
        part = out[..., rows]
        moved = np.zeros((6, AXES + BASE_ROWS * tree.floating, part.shape[-1]))  # the base, and its axes if it floats
        moved[:, AXES:] = np.eye(6)[:, : moved.shape[1] - AXES, None]
        moved[:3, ACCELERATION] = -tree.gravity[:, None]
        if base is not None:
            moved[:, VELOCITY], moved[:, ACCELERATION] = base.velocity[rows].T, base.acceleration[rows].T
        motions = [moved]
        if tree.floating:
            _fill_body(motions[0], layouts[0], part)
        for j, joint in enumerate(tree.joints):
            motion = carry(joint, motions[joint.parent + 1], joint.sign * q[rows, j])
            _add_rates(joint, motion, joint.sign * v[rows, j], joint.sign * a[rows, j])
            _fill_body(motion, layouts[j + tree.floating], part)
            motions.append(motion)


def fill_reduced_regressor(
    reduction: Reduction,
    tree: Tree,
    q: FloatArray,
    v: FloatArray,
    a: FloatArray,
    out: FloatArray,
    base: BaseSamples | None = None,
    G: FloatArray | None = None,
) -> None:
    """Write the regressor of base parameters: columns of Pinocchio's, combined where the reduction says so.

    With closed loops, G (t, n, N) takes the rows of all joints to those of the independent ones.
    """
    columns, spread = reduction.columns, reduction.spread
    if reduction.selects and G is None:
        fill_tree_regressor(tree, q, v, a, columns, out, base)
        return
    for start in range(0, len(q), BLOCK):  # limits the memory of Pinocchio's wide regressor
        rows = slice(start, start + BLOCK)
        part = out[..., rows]
        Y = np.zeros((len(columns), tree.rows, part.shape[-1]))
        moved = None if base is None else BaseSamples(*(x[rows] for x in base))
        fill_tree_regressor(tree, q[rows], v[rows], a[rows], columns, Y, moved)
        if G is not None:
            Y = np.einsum("ktb,tib->kib", Y, G[..., rows])
        part[:] = Y if reduction.selects else np.tensordot(spread[columns].T, Y, axes=1)


class _Run(NamedTuple):
    """Consecutive joints that carry a body."""

    vectors: slice  # places of their axes among the motion vectors of the body
    rows: slice  # their rows in the output
    linear: bool  # whether their axes have no angular part


class _Layout(NamedTuple):
    """Requested columns of one body, and the rows in which they are not zero."""

    mass: slice  # place of the mass in the output, zero or one columns
    moments: slice  # places of the first moments
    inertias: slice  # places of the inertias
    moment_axes: tuple[int, ...]  # axes of the first moments
    inertia_axes: tuple[tuple[int, int], ...]  # pairs of axes of the inertias
    # rows whose axis is one of the body's own: row, component of the wrench, sign
    own: tuple[tuple[int, int, float], ...]
    runs: tuple[_Run, ...]  # the other rows

    @classmethod
    def of(cls, tree: Tree, body: int, columns: Sequence[int] | NDArray[np.intp]) -> _Layout:
        """Lay out the columns of a body."""
        asked = [int(k) - 10 * body for k in columns if int(k) // 10 == body]
        first = sum(int(k) // 10 < body for k in columns)
        moments = tuple(k - 1 for k in asked if 1 <= k <= 3)
        inertias = tuple(INERTIAS[k] for k in asked if k > 3)
        ends = np.cumsum([first, asked.count(0), len(moments), len(inertias)]).tolist()
        mass, moment, inertia = (slice(start, stop) for start, stop in pairwise(ends))
        if body < tree.floating:
            return cls(mass, moment, inertia, moments, inertias, tuple((row, row, 1.0) for row in range(BASE_ROWS)), ())
        joint = tree.joints[body - tree.floating]
        straight = joint.after is None
        own = ((joint.carriers[-1], int(np.flatnonzero(joint.own_axis)[0]), joint.sign),) if straight else ()
        others = joint.carriers[:-1] if straight else joint.carriers
        return cls(mass, moment, inertia, moments, inertias, own, tuple(_runs(others, floating=tree.floating)))


def _runs(carriers: tuple[int, ...], *, floating: bool) -> Iterator[_Run]:
    """Cut rows into runs of consecutive ones; a floating base first has three without angular part."""
    linear = 3 if floating else 0
    breaks = [k for k in range(1, len(carriers)) if k == linear or carriers[k] != carriers[k - 1] + 1]
    for first, stop in zip([0, *breaks], [*breaks, len(carriers)], strict=True):
        rows = slice(carriers[first], carriers[first] + stop - first) if stop > first else slice(0)
        yield _Run(slice(AXES + first, AXES + stop), rows, stop <= linear)


def _add_rates(joint: TreeJoint, motion: FloatArray, v: FloatArray, a: FloatArray) -> None:
    """Add the joint's own velocity S v and acceleration S a + ν × S v, and turn an oblique axis back."""
    i, j, k = CYCLIC[joint.axis]
    parts = motion.reshape(2, 3, *motion.shape[1:])
    own = parts[int(joint.turns), i]
    own[VELOCITY] += v
    own[ACCELERATION] += a
    for target, source in ((0, 0), (1, 1)) if joint.turns else ((0, 1),):
        parts[target, j, ACCELERATION] += parts[source, k, VELOCITY] * v
        parts[target, k, ACCELERATION] -= parts[source, j, VELOCITY] * v
    turn_back(joint, motion)


def _fill_body(motion: FloatArray, layout: _Layout, out: FloatArray) -> None:
    """Write the columns of a body: s · wrench in the row of each joint that carries it."""
    force, moment, inertia = _wrenches(motion, layout)
    for row, component, sign in layout.own:
        np.multiply(moment[component], sign, out=out[layout.moments, row])
        if component < 3:
            np.multiply(force[component], sign, out=out[layout.mass, row])
        else:
            np.multiply(inertia[component - 3], sign, out=out[layout.inertias, row])
    for run in layout.runs:
        s = motion[:, run.vectors]
        parts = slice(3) if run.linear else slice(6)
        if len(layout.moment_axes):
            np.einsum("ckb,cib->ikb", s[parts], moment[parts], out=out[layout.moments, run.rows])
        if layout.mass.stop > layout.mass.start:
            np.einsum("ckb,cb->kb", s[:3], force, out=out[layout.mass.start, run.rows])
        if len(layout.inertia_axes) and not run.linear:
            np.einsum("ckb,cib->ikb", s[3:], inertia, out=out[layout.inertias, run.rows])


def _wrenches(motion: FloatArray, layout: _Layout) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Force of a unit mass (3, B), wrenches of unit first moments (6, k, B), torques of unit inertias (3, k, B)."""
    (linear, omega), acceleration = motion[:, VELOCITY].reshape(2, 3, -1), motion[:, ACCELERATION]
    squares = omega[:, None] * omega
    force, alpha = acceleration[:3].copy(), acceleration[3:]
    for i, j, k in CYCLIC:
        force[i] += omega[j] * linear[k] - omega[k] * linear[j]
    moment = np.empty((6, len(layout.moment_axes), motion.shape[-1]))
    inertia = np.empty((3, len(layout.inertia_axes), motion.shape[-1]))
    for place, axis in enumerate(layout.moment_axes):
        _moment_wrench(axis, force, alpha, squares, moment[:, place])
    for place, axes in enumerate(layout.inertia_axes):
        _inertia_torque(axes, alpha, squares, inertia[:, place])
    return force, moment, inertia


def _moment_wrench(axis: int, force: FloatArray, alpha: FloatArray, squares: FloatArray, wrench: FloatArray) -> None:
    """Force α × e + ω × (ω × e) and torque e × a of a first moment along e, (6, B)."""
    i, j, k = CYCLIC[axis]
    np.negative(np.add(squares[j, j], squares[k, k], out=wrench[i]), out=wrench[i])
    np.add(squares[i, j], alpha[k], out=wrench[j])
    np.subtract(squares[i, k], alpha[j], out=wrench[k])
    wrench[3 + i] = 0.0
    np.negative(force[k], out=wrench[3 + j])
    wrench[3 + k] = force[j]


def _inertia_torque(axes: tuple[int, int], alpha: FloatArray, squares: FloatArray, torque: FloatArray) -> None:
    """Torque I α + ω × I ω of an inertia I = e_i e_iᵀ, or e_i e_jᵀ + e_j e_iᵀ with j behind i, (3, B)."""
    i, j, k = CYCLIC[axes[0]]
    if axes[0] == axes[1]:
        torque[i] = alpha[i]
        torque[j] = squares[k, i]
        np.negative(squares[j, i], out=torque[k])
    else:
        np.subtract(alpha[j], squares[k, i], out=torque[i])
        np.add(alpha[i], squares[k, j], out=torque[j])
        np.subtract(squares[i, i], squares[j, j], out=torque[k])
