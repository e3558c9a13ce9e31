"""Contacts that bend before they slide."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray

from .internal_state import InternalState


@dataclass(frozen=True)
class Presliding(InternalState):
    """Rate-independent hysteresis after Dahl: dz/dq = (1 − z sgn(dq)) / δ, between −1 and 1.

    z takes the place of sgn(v) in dry friction: after a reversal it goes from one sign to the other over a way of a few
    δ instead of at once. (P. R. Dahl, A solid friction model, 1968, with exponent 1.) It depends on the way, not on how
    fast it is gone.

    Between samples, z ← s + (z − s) exp(−|Δq| / δ) with s = sgn(Δq) is exact where the joint does not turn back. Up to
    the next reversal the ways add up: z = s + (z₀ − s) exp(−Σ|Δq| / δ). From one reversal to the next this is a linear
    recurrence, which is solved by composing maps in pairs, so that nothing is looped over.

    Attributes:
        length: δ [rad], about the angle over which the contact bends.
    """

    length: float

    def states(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """State z, (N,).

        It starts at sgn(v) of the first sample, as if the joint had come that way: 0 at rest. Where the velocity of two
        neighbours is zero no way is counted between them, so that poses taken one by one remember nothing.
        """
        if len(q) == 0:
            return np.zeros(0)
        step = np.diff(q, prepend=q[:1])
        step[1:][(v[1:] == 0.0) & (v[:-1] == 0.0)] = 0.0
        return hysteresis(step, self.length, float(np.sign(v[0])))


def hysteresis(step: FloatArray, length: float, start: float) -> FloatArray:
    """State of :class:`Presliding` after each step.

    Args:
        step: Way from one sample to the next [rad], (N,).
        length: δ [rad].
        start: State before the first step.
    """
    sign = np.sign(step)
    moving = np.flatnonzero(sign)
    if len(moving) == 0:
        return np.full(len(step), start)
    turns = moving[np.flatnonzero(np.diff(sign[moving], prepend=0.0))]  # first step of each stretch of one sign
    stretch = np.clip(np.searchsorted(turns, np.arange(len(step)), side="right") - 1, 0, None)
    way = np.cumsum(np.abs(step)) / length
    before = np.where(turns > 0, way[turns - 1], 0.0)
    directions = sign[turns]
    decay = np.exp(before - np.append(before[1:], way[-1]))
    first = np.append(start, _recurrence(decay, (1.0 - decay) * directions, start)[:-1])
    s = directions[stretch]
    z = s + (first[stretch] - s) * np.exp(np.minimum(before[stretch] - way, 0.0))
    z[: turns[0]] = start
    return np.asarray(z)


def _recurrence(factor: FloatArray, summand: FloatArray, start: float) -> FloatArray:
    """x_k = factor_k x_{k−1} + summand_k from x_{−1} = ``start``, by composing maps over 1, 2, 4, … places."""
    factor, x = factor.copy(), summand.copy()
    x[0] += factor[0] * start
    factor[0] = 0.0
    reach = 1
    while reach < len(x) and factor[reach:].any():
        x[reach:] += factor[reach:] * x[:-reach].copy()
        factor[reach:] *= factor[:-reach].copy()
        reach *= 2
    return x
