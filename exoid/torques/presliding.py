"""Presliding: the internal state of dry friction, which depends on all motion of its joint before."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray


@dataclass(frozen=True)
class Presliding:
    """Rate-independent hysteresis after Dahl: dz/dq = (1 − z sgn(dq)) / δ, between −1 and 1.

    z replaces sgn(v) in dry friction. After a reversal it changes sign over a distance of a few δ instead of at once
    (P. R. Dahl, A solid friction model, 1968, with exponent 1). It depends on the path, not on the velocity.

    Between samples, z ← s + (z − s) exp(−|Δq| / δ) with s = sgn(Δq) is exact if the joint does not reverse in between.
    Up to the next reversal the distances add up: z = s + (z₀ − s) exp(−Σ|Δq| / δ). From reversal to reversal this is a
    linear recurrence, which is solved by composing maps in pairs, without a loop over samples. Equal objects are one
    state: terms of a joint share it.

    Attributes:
        length: Presliding length δ [rad].
    """

    length: float

    def states(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """Compute the state z at each sample.

        Args:
            q: Angle of the joint [rad], (N,), in time order.
            v: Velocity of the joint [rad/s], (N,).

        Returns:
            State at each sample, (N,).
        """
        # It starts at sgn(v) of the first sample, as if the joint had slid in that direction. At rest it starts at 0,
        # as friction may be of either sign: |v| is at most 5 % of its RMS, as noise of the angle is. It does not
        # change between two samples of zero velocity, so that separate poses do not affect each other.
        if len(q) == 0:
            return np.zeros(0)
        step = np.diff(q, prepend=q[:1])
        step[1:][(v[1:] == 0.0) & (v[:-1] == 0.0)] = 0.0
        # Speed of the first sample, over the RMS velocity, up to which a recording begins at rest
        slides = abs(v[0]) > 0.05 * np.sqrt(np.mean(v**2))
        start, sign = float(np.sign(v[0])) if slides else 0.0, np.sign(step)
        moving = np.flatnonzero(sign)
        if len(moving) == 0:
            return np.full(len(step), start)
        turns = moving[np.flatnonzero(np.diff(sign[moving], prepend=0.0))]  # first step in each direction
        counts = np.diff(np.append(0, turns[1:]), append=len(step))
        path = np.cumsum(np.abs(step)) / self.length
        before = np.where(turns > 0, path[turns - 1], 0.0)
        directions = sign[turns]
        factor = np.exp(before - np.append(before[1:], path[-1]))
        # z_k ← factor_k z_{k−1} + x_k from z_{−1} = start on, by composing maps over 1, 2, 4, … reversals
        x, reach = (1.0 - factor) * directions, 1
        x[0] += factor[0] * start
        while reach < len(x) and factor[reach:].any():
            x[reach:] += factor[reach:] * x[:-reach].copy()
            factor[reach:] *= factor[:-reach].copy()
            reach *= 2
        first = np.insert(x[:-1], 0, start)
        s, first, before = (np.repeat(x, counts) for x in (directions, first, before))
        z = s + (first - s) * np.exp(np.minimum(before - path, 0.0))
        z[: turns[0]] = start
        return np.asarray(z)
