"""Motions that rigs follow in the documents' experiments, of B rigs at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.rig import Target


@dataclass(frozen=True)
class Hold:
    """Stay at a pose.

    Attributes:
        pose: [rad], (n, B).
    """

    pose: FloatArray

    def at(self, time: float) -> Target:
        """See :class:`exoid.rig.Reference`."""
        still = np.zeros_like(self.pose)
        return Target(self.pose, still, still)


@dataclass(frozen=True)
class Approach:
    """Go smoothly from one pose to another and stay there: θ = a + (b − a)(10 s³ − 15 s⁴ + 6 s⁵), s = t/T.

    Attributes:
        start: [rad], (n, B).
        pose: [rad], (n, B).
        duration: T [s].
    """

    start: FloatArray
    pose: FloatArray
    duration: float

    def at(self, time: float) -> Target:
        """See :class:`exoid.rig.Reference`."""
        s = min(max(time / self.duration, 0.0), 1.0)
        way = self.pose - self.start
        share = s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
        rate = 30.0 * s * s * (1.0 - s) ** 2 / self.duration
        change = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / self.duration**2
        return Target(self.start + share * way, rate * way, change * way)


@dataclass(frozen=True)
class Harmonics:
    """A sum of sinusoids, θ = centre + Σ_k amplitude_k sin(ω_k t + phase_k).

    Attributes:
        centre: [rad], (n, B).
        amplitude: [rad], (K, n, B).
        frequency: ω [rad/s], (K, n, B) or what spreads to it.
        phase: [rad], (K, n, B).
    """

    centre: FloatArray
    amplitude: FloatArray
    frequency: FloatArray
    phase: FloatArray

    @staticmethod
    def join(motions: Sequence[Harmonics]) -> Harmonics:
        """Put motions side by side; those of fewer sinusoids get some of amplitude zero."""
        most = max(len(motion.amplitude) for motion in motions)

        def wide(x: FloatArray, motion: Harmonics) -> FloatArray:
            full = np.broadcast_to(x, motion.amplitude.shape)
            return np.concatenate([full, np.zeros((most - len(full), *full.shape[1:]))])

        return Harmonics(
            np.concatenate([motion.centre for motion in motions], axis=-1),
            np.concatenate([wide(motion.amplitude, motion) for motion in motions], axis=-1),
            np.concatenate([wide(motion.frequency, motion) for motion in motions], axis=-1),
            np.concatenate([wide(motion.phase, motion) for motion in motions], axis=-1),
        )

    def each(self, count: int) -> Harmonics:
        """Repeat all rigs: the whole row of them ``count`` times."""
        shape = self.amplitude.shape
        return Harmonics(
            np.tile(self.centre, count),
            np.tile(self.amplitude, count),
            np.tile(np.broadcast_to(self.frequency, shape), count),
            np.tile(np.broadcast_to(self.phase, shape), count),
        )

    def at(self, time: float) -> Target:
        """See :class:`exoid.rig.Reference`."""
        argument = self.frequency * time + self.phase
        sine = self.amplitude * np.sin(argument)
        return Target(
            self.centre + sine.sum(axis=0),
            (self.amplitude * self.frequency * np.cos(argument)).sum(axis=0),
            -(self.frequency**2 * sine).sum(axis=0),
        )

    def acceleration(self, time: float) -> FloatArray:
        """Accelerations at a time [rad/s²], (n, B)."""
        argument = self.frequency * time + self.phase
        return np.asarray(-(self.amplitude * self.frequency**2 * np.sin(argument)).sum(axis=0))
