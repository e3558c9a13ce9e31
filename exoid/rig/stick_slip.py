"""Joints that truly stick and slip: friction solved together with the dynamics of each step.

The velocity after a step minimises the convex function

    ½ vᵀ M v − bᵀ v + Σ c_i |v_i|,      b = momentum after the step without friction, c the largest friction impulse,

whose optimality conditions are Coulomb's law: the impulse r = b − M v that friction takes is c_i sgn(v_i) at a joint
that moves and anything up to c_i at one that rests. An end stop widens the range of r on its side, static friction
widens it at rest. For a given pattern of moving and resting joints this is a small linear system; the pattern is
guessed from the last step, checked, and corrected. Resting joints come out with a velocity of exactly zero.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray

CORRECTIONS = 12
"""Patterns tried before falling back on coordinate descent, which always ends."""

SWEEPS = 500


class Friction(NamedTuple):
    """Impulses that friction and end stops can take in one step [N·m·s], (n, B) each.

    Attributes:
        kinetic: c, at a moving joint.
        low: Least r at a resting joint: minus the static one, or −inf at a lower end stop.
        high: Largest r at a resting joint: the static one, or inf at an upper end stop.
    """

    kinetic: FloatArray
    low: FloatArray
    high: FloatArray

    def of(self, rigs: NDArray[np.intp]) -> Friction:
        """Those of some rigs."""
        return Friction(self.kinetic[:, rigs], self.low[:, rigs], self.high[:, rigs])


class _Attempt(NamedTuple):
    """Velocities for one pattern, the pattern they call for instead, and which rigs differ."""

    v: FloatArray
    pattern: FloatArray
    wrong: NDArray[np.bool_]


def solve_stick_slip(M: FloatArray, b: FloatArray, friction: Friction, last: FloatArray) -> FloatArray:
    """Find the velocities of B rigs after a step.

    Args:
        M: Mass matrices, with whatever acts implicitly on their diagonals, (n, n, B).
        b: Momenta without friction and stops, (n, B).
        friction: What friction and stops can take.
        last: Velocities before the step: what is zero is guessed to rest, (n, B).

    Returns:
        Velocities, (n, B), exactly zero where a joint rests.
    """
    v, pattern, wrong = _attempt(M, b, friction, np.sign(last))
    rigs = np.flatnonzero(wrong)
    for _ in range(CORRECTIONS):
        if not len(rigs):
            return v
        v[:, rigs], pattern[:, rigs], wrong = _attempt(M[..., rigs], b[:, rigs], friction.of(rigs), pattern[:, rigs])
        rigs = rigs[wrong]
    if len(rigs):
        v[:, rigs] = descend(M[..., rigs], b[:, rigs], friction.of(rigs))
    return v


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


def _attempt(M: FloatArray, b: FloatArray, friction: Friction, pattern: FloatArray) -> _Attempt:
    """Solve for a pattern of signs, 0 for rest, and see which pattern the solution calls for."""
    into_stop = ((pattern > 0.0) & (friction.high == np.inf)) | ((pattern < 0.0) & (friction.low == -np.inf))
    pattern = np.where(into_stop, 0.0, pattern)
    moving = np.abs(pattern)
    v = _eliminate(M, (b - friction.kinetic * pattern) * moving, moving)
    taken = b - (M * v).sum(axis=1)  # M is symmetric: sums over rows and over columns are alike
    onwards = np.where(v * pattern > 0.0, pattern, 0.0)
    started = (taken > friction.high).astype(np.float64) - (taken < friction.low)
    called_for = np.where(moving > 0.0, onwards, started)
    return _Attempt(v, called_for, (called_for != pattern).any(axis=0))


def _eliminate(M: FloatArray, rhs: FloatArray, moving: FloatArray) -> FloatArray:
    """Solve M v = rhs for moving joints, v = 0 for the others, by elimination without pivots (M is definite)."""
    n = len(rhs)
    A = M * moving * moving[:, None]
    diagonal = np.arange(n)
    A[diagonal, diagonal] += 1.0 - moving
    v = rhs.copy()
    for k in range(n - 1):
        factor = A[k + 1 :, k] / A[k, k]
        A[k + 1 :, k + 1 :] -= factor[:, None] * A[k, k + 1 :]
        v[k + 1 :] -= factor * v[k]
    for k in range(n - 1, -1, -1):
        for j in range(k + 1, n):
            v[k] -= A[k, j] * v[j]
        v[k] /= A[k, k]
    return v
