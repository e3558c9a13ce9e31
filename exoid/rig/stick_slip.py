"""Joints that truly stick and slip: friction solved together with the dynamics of each step.

The velocity after a step minimises the convex function

    ½ vᵀ M v − bᵀ v + Σ c_i |v_i|,      b = momentum after the step without friction, c the largest friction impulse,

whose optimality conditions are Coulomb's law: the impulse r = b − M v that friction takes is c_i sgn(v_i) at a joint
that moves and anything up to c_i at one that rests. An end stop widens the range of r on its side, static friction
widens it at rest. For a given pattern of moving and resting joints this is a small linear system; the pattern is
guessed from the last step, checked, and corrected. Resting joints come out with a velocity of exactly zero.

A joint that turns round within a step, after the share s = |v| / (|v| + |v⁺|) of it, rubs one way before and the other
way after: c (1 − 2 s) sgn(v⁺). So friction takes energy in that step too, r · ½ (v + v⁺) ≥ 0.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray

CORRECTIONS = 12
"""Patterns tried before falling back on coordinate descent, which always ends."""

SWEEPS = 500

TURNS = 2
"""Times that the share of the step before a joint turns round is worked out."""


class Friction(NamedTuple):
    """Impulses that friction and end stops can take in one step [N·m·s], (n, B) each.

    Attributes:
        kinetic: c, at a moving joint.
        low: Least r at a resting joint: minus the static one, or −inf at a lower end stop.
        high: Largest r at a resting joint: the static one, or inf at an upper end stop.
        stops: Whether any joint may be at an end stop; where none is, saying so saves time.
    """

    kinetic: FloatArray
    low: FloatArray
    high: FloatArray
    stops: bool = True

    def of(self, rigs: NDArray[np.intp]) -> Friction:
        """Those of some rigs."""
        return Friction(self.kinetic[:, rigs], self.low[:, rigs], self.high[:, rigs], self.stops)


class Slip(NamedTuple):
    """Solution of the stick-slip problem, (n, B) each.

    Attributes:
        v: Velocities after the step, exactly zero where a joint rests.
        taken: Impulses r = b − M v that friction and end stops take.
    """

    v: FloatArray
    taken: FloatArray


def solve_stick_slip(M: FloatArray, impulse: FloatArray, friction: Friction, last: FloatArray) -> Slip:
    """Find the velocities of B rigs after a step.

    Args:
        M: Mass matrices, with whatever acts implicitly on their diagonals, (n, n, B).
        impulse: What all but friction and stops give, so that b = M v + impulse [N·m·s], (n, B).
        friction: What friction and stops can take.
        last: Velocities v before the step: what is zero is guessed to rest, (n, B).
    """
    pattern = np.sign(last)
    if friction.stops:
        pattern[((pattern > 0.0) & (friction.high == np.inf)) | ((pattern < 0.0) & (friction.low == -np.inf))] = 0.0
    resting = pattern == 0.0
    if resting.any():
        slip, right = _go_on(M, impulse, friction, last, pattern, resting)
    else:
        taken = friction.kinetic * pattern
        slip = Slip(last + eliminate(M, impulse - taken), taken)
        right = slip.v * pattern > 0.0
    if not right.all():
        rigs = np.flatnonzero(~right.all(axis=0))
        part = M[..., rigs]
        b = (part * last[:, rigs]).sum(axis=1) + impulse[:, rigs]
        wrong = Slip(slip.v[:, rigs], slip.taken[:, rigs])
        corrected = _correct(part, b, friction.of(rigs), pattern[:, rigs], wrong)
        slip.v[:, rigs], slip.taken[:, rigs] = _turn(part, b, friction.of(rigs), last[:, rigs], corrected)
    return slip


def descend(M: FloatArray, b: FloatArray, friction: Friction) -> FloatArray:
    """Minimise one joint at a time, from rest, until nothing changes: slow and sure."""
    v = np.zeros_like(b)
    for _ in range(SWEEPS):
        before = v.copy()
        for i in range(len(b)):
            free = b[i] - (M[i] * v).sum(axis=0) + M[i, i] * v[i]
            forward, backward = free > friction.high[i], free < friction.low[i]
            shrunk = np.where(forward, free - friction.kinetic[i], np.where(backward, free + friction.kinetic[i], 0.0))
            v[i] = shrunk / M[i, i]
        if np.abs(v - before).max() <= 1e-15 * max(1.0, float(np.abs(v).max())):
            break
    return v


def _go_on(
    M: FloatArray,
    impulse: FloatArray,
    friction: Friction,
    last: FloatArray,
    pattern: FloatArray,
    resting: NDArray[np.bool_],
) -> tuple[Slip, NDArray[np.bool_]]:
    """Solve for a pattern with some joints at rest, and tell which joints it is right for."""
    stopped = last * resting  # not zero where a joint runs into its stop
    b = impulse + (M * stopped).sum(axis=1) if stopped.any() else impulse
    change = eliminate(M, b - friction.kinetic * pattern, np.abs(pattern))
    taken = b - (M * change).sum(axis=1)  # M is symmetric: sums over rows and over columns are alike
    v = last - stopped
    v += change
    right = resting & (taken <= friction.high)
    right &= taken >= friction.low
    right |= v * pattern > 0.0
    return Slip(v, taken), right


def _correct(M: FloatArray, b: FloatArray, friction: Friction, pattern: FloatArray, slip: Slip) -> Slip:
    """Go on from a pattern to the one that its solution calls for, until they agree."""
    for _ in range(CORRECTIONS):
        called_for = _called_for(friction, pattern, slip)
        if (called_for == pattern).all():
            return slip
        pattern = called_for
        slip = _solve(M, b, friction, pattern)
    circling = np.flatnonzero((_called_for(friction, pattern, slip) != pattern).any(axis=0))
    slip.v[:, circling] = descend(M[..., circling], b[:, circling], friction.of(circling))
    return Slip(slip.v, b - (M * slip.v).sum(axis=1))


def _turn(M: FloatArray, b: FloatArray, friction: Friction, last: FloatArray, slip: Slip) -> Slip:
    """Let joints that turn round rub the old way before they do."""
    for _ in range(TURNS):
        turned = slip.v * last < 0.0
        if not turned.any():
            break
        share = np.divide(last, last - slip.v, out=np.zeros_like(last), where=turned)
        before = b - 2.0 * share * np.sign(last) * friction.kinetic
        v = _correct(M, before, friction, np.sign(slip.v), _solve(M, before, friction, np.sign(slip.v))).v
        slip = Slip(v, b - (M * v).sum(axis=1))
    return slip


def _solve(M: FloatArray, b: FloatArray, friction: Friction, pattern: FloatArray) -> Slip:
    """Solution for a pattern, right or not."""
    v = eliminate(M, b - friction.kinetic * pattern, np.abs(pattern))
    return Slip(v, b - (M * v).sum(axis=1))


def _called_for(friction: Friction, pattern: FloatArray, slip: Slip) -> FloatArray:
    """Pattern that a solution suggests: what would turn back comes to rest, what is overpowered moves."""
    started = np.subtract(slip.taken > friction.high, slip.taken < friction.low, dtype=np.float64)
    started *= pattern == 0.0
    started += pattern * (slip.v * pattern > 0.0)
    return started


def eliminate(M: FloatArray, rhs: FloatArray, moving: FloatArray | None = None) -> FloatArray:
    """Solve M v = rhs for joints with ``moving`` = 1 (None: for all), v = 0 for the others.

    M is definite, so no pivots are sought. Only the upper triangle is kept up, with the right-hand side as a further
    column.
    A resting joint needs no row and column taken out: the inverse of its pivot is set to zero.
    """
    n = len(rhs)
    U = np.concatenate([M, rhs[:, None]], axis=1)
    inverse = np.empty_like(rhs)
    for k in range(n):
        row = U[k]
        np.divide(1.0 if moving is None else moving[k], row[k], out=inverse[k])
        for i in range(k + 1, n):
            U[i, i:] -= row[i] * inverse[k] * row[i:]
    v = U[:, n].copy()
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            v[i] -= U[i, k] * v[k]
        v[i] *= inverse[i]
    return v
