"""Stick-slip friction: Coulomb's law solved together with the dynamics of each step.

The velocity after a step minimises the convex function

    ½ vᵀ M v − bᵀ v + Σ c_i |v_i|,      b = momentum after the step without friction, c the largest friction impulse,

whose optimality conditions are Coulomb's law. The friction impulse r = b − M v is c_i sgn(v_i) at a moving joint and at
most c_i at a resting one. An end stop extends the range of r on its side, static friction extends it at rest. For a
given pattern of moving and resting joints the problem is a small linear system. The pattern is guessed from the last
step, checked and corrected. Resting joints have a velocity of exactly zero.

A joint that reverses within a step does so after the fraction s = |v| / (|v| + |v⁺|). Its friction impulse is then
c (1 − 2 s) sgn(v⁺), so that friction dissipates energy in that step too: r · ½ (v + v⁺) ≥ 0.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray


class Friction(NamedTuple):
    """Admissible impulses of friction and end stops in one step [N·m·s], (n, B) each."""

    kinetic: FloatArray  # impulse c at a moving joint
    low: FloatArray  # smallest r at a resting joint: minus the static impulse, or −inf at a lower end stop
    high: FloatArray  # largest r at a resting joint: the static impulse, or inf at an upper end stop
    stops: bool = True  # whether any joint may be at an end stop; False saves time

    def of(self, rigs: NDArray[np.intp]) -> Friction:
        """Select the impulses of some rigs."""
        return Friction(self.kinetic[:, rigs], self.low[:, rigs], self.high[:, rigs], self.stops)


class Slip(NamedTuple):
    """Solution of the stick-slip problem, (n, B) each."""

    v: FloatArray  # velocities after the step [rad/s], exactly zero where a joint rests
    impulse: FloatArray  # impulses r = b − M v of friction and end stops [N·m·s]


def solve_stick_slip(M: FloatArray, impulse: FloatArray, friction: Friction, last: FloatArray) -> Slip:
    """Find the velocities of B rigs after a step."""
    pattern = np.sign(last)
    if friction.stops:
        pattern[((pattern > 0.0) & (friction.high == np.inf)) | ((pattern < 0.0) & (friction.low == -np.inf))] = 0.0
    resting = pattern == 0.0
    if resting.any():
        slip, right = _solve_change(M, impulse, friction, last, pattern, resting)
    else:
        r = friction.kinetic * pattern
        slip = Slip(last + eliminate(M, impulse - r), r)
        right = slip.v * pattern > 0.0
    if not right.all():
        rigs = np.flatnonzero(~right.all(axis=0))
        part = M[..., rigs]
        b = (part * last[:, rigs]).sum(axis=1) + impulse[:, rigs]
        wrong = Slip(slip.v[:, rigs], slip.impulse[:, rigs])
        corrected = _correct(part, b, friction.of(rigs), pattern[:, rigs], wrong)
        slip.v[:, rigs], slip.impulse[:, rigs] = _reverse(part, b, friction.of(rigs), last[:, rigs], corrected)
    return slip


def descend(M: FloatArray, b: FloatArray, friction: Friction) -> FloatArray:
    """Minimise by coordinate descent from rest, one joint at a time."""
    v = np.zeros_like(b)
    for _ in range(500):  # sweeps; it always converges
        before = v.copy()
        for i in range(len(b)):
            free = b[i] - (M[i] * v).sum(axis=0) + M[i, i] * v[i]
            forward, backward = free > friction.high[i], free < friction.low[i]
            shrunk = np.where(forward, free - friction.kinetic[i], np.where(backward, free + friction.kinetic[i], 0.0))
            v[i] = shrunk / M[i, i]
        if np.abs(v - before).max() <= 1e-15 * max(1.0, float(np.abs(v).max())):
            break
    return v


def _solve_change(
    M: FloatArray,
    impulse: FloatArray,
    friction: Friction,
    last: FloatArray,
    pattern: FloatArray,
    resting: NDArray[np.bool_],
) -> tuple[Slip, NDArray[np.bool_]]:
    """Solve for the change of velocity under a pattern; return also the joints for which the pattern is right."""
    stopped = last * resting  # not zero where a joint reaches its stop
    b = impulse + (M * stopped).sum(axis=1) if stopped.any() else impulse
    change = eliminate(M, b - friction.kinetic * pattern, np.abs(pattern))
    r = b - (M * change).sum(axis=1)  # M is symmetric: sums over rows and over columns are alike
    v = last - stopped
    v += change
    right = resting & (r <= friction.high)
    right &= r >= friction.low
    right |= v * pattern > 0.0
    return Slip(v, r), right


def _correct(M: FloatArray, b: FloatArray, friction: Friction, pattern: FloatArray, slip: Slip) -> Slip:
    """Correct the pattern until it agrees with its solution."""
    for _ in range(12):  # then coordinate descent, which always converges
        corrected = _corrected_pattern(friction, pattern, slip)
        if (corrected == pattern).all():
            return slip
        pattern = corrected
        slip = _solve(M, b, friction, pattern)
    cycling = np.flatnonzero((_corrected_pattern(friction, pattern, slip) != pattern).any(axis=0))
    slip.v[:, cycling] = descend(M[..., cycling], b[:, cycling], friction.of(cycling))
    return Slip(slip.v, b - (M * slip.v).sum(axis=1))


def _reverse(M: FloatArray, b: FloatArray, friction: Friction, last: FloatArray, slip: Slip) -> Slip:
    """Apply friction in the old direction until the joint reverses."""
    for _ in range(2):  # for the time of the reversal
        reversed_ = slip.v * last < 0.0
        if not reversed_.any():
            break
        share = np.divide(last, last - slip.v, out=np.zeros_like(last), where=reversed_)
        before = b - 2.0 * share * np.sign(last) * friction.kinetic
        v = _correct(M, before, friction, np.sign(slip.v), _solve(M, before, friction, np.sign(slip.v))).v
        slip = Slip(v, b - (M * v).sum(axis=1))
    return slip


def _solve(M: FloatArray, b: FloatArray, friction: Friction, pattern: FloatArray) -> Slip:
    """Solve the linear system of a pattern."""
    v = eliminate(M, b - friction.kinetic * pattern, np.abs(pattern))
    return Slip(v, b - (M * v).sum(axis=1))


def _corrected_pattern(friction: Friction, pattern: FloatArray, slip: Slip) -> FloatArray:
    """Pattern after a solution: joints that would reverse come to rest, joints beyond static friction start to move."""
    started = np.subtract(slip.impulse > friction.high, slip.impulse < friction.low, dtype=np.float64)
    started *= pattern == 0.0
    started += pattern * (slip.v * pattern > 0.0)
    return started


def eliminate(M: FloatArray, rhs: FloatArray, moving: FloatArray | None = None) -> FloatArray:
    """Solve M v = rhs by Gaussian elimination for B systems at once, with v = 0 for resting joints."""
    # M is positive definite, so pivoting is not needed. Only the upper triangle is updated, with the right-hand side as
    # an additional column. The inverse pivot of a resting joint is set to zero.
    n = len(rhs)
    if rhs.shape[1] == 1 and moving is None:  # one small system: LAPACK is faster than array operations
        return np.asarray(np.linalg.solve(M[..., 0], rhs))
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
