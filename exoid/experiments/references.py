"""Reference motions of B rigs, and Fourier series fitted to measured angles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError
from exoid.rig import Reference, Target
from exoid.tools.numbers import checked


class States(NamedTuple):
    """Samples of a motion, (N, n) each."""

    q: FloatArray  # angles [rad]
    v: FloatArray  # velocities [rad/s]
    a: FloatArray  # accelerations [rad/s²]


def minimum_jerk(s: ArrayLike) -> FloatArray:
    """Rise from 0 to 1 with zero velocity and acceleration at both ends, 10 s³ − 15 s⁴ + 6 s⁵.

    Args:
        s: Argument, clipped to 0 to 1.

    Returns:
        The polynomial.

    Example:
        >>> minimum_jerk([0.0, 0.5, 1.0, 2.0])
        array([0. , 0.5, 1. , 1. ])
    """
    s = np.clip(np.asarray(s, dtype=np.float64), 0.0, 1.0)
    return np.asarray(s**3 * (10.0 - 15.0 * s + 6.0 * s * s))


@dataclass(frozen=True, repr=False)
class Hold(Reference):
    """Constant pose.

    Attributes:
        pose: Angles [rad], (n, B).
    """

    pose: FloatArray

    def at(self, time: float) -> Target:
        """Evaluate the motion: the pose, at rest."""
        still = np.zeros_like(self.pose)
        return Target(self.pose, still, still)


@dataclass(frozen=True, repr=False)
class Approach(Reference):
    """Smooth motion from pose a to pose b, then rest: by :func:`minimum_jerk` of t/T.

    Attributes:
        start: Initial angles a [rad], (n, B).
        pose: Final angles b [rad], (n, B).
        duration: Time of travel T [s].
    """

    start: FloatArray
    pose: FloatArray
    duration: float

    def at(self, time: float) -> Target:
        """Evaluate the motion."""
        s = min(max(time / self.duration, 0.0), 1.0)
        way = self.pose - self.start
        rate = 30.0 * s * s * (1.0 - s) ** 2 / self.duration
        change = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / self.duration**2
        return Target(self.start + minimum_jerk(s) * way, rate * way, change * way)


@dataclass(frozen=True, repr=False)
class Harmonics(Reference):
    """Sum of sinusoids, θ = centre + Σ_k amplitude_k sin(ω_k t + phase_k).

    Attributes:
        centre: Mean angles [rad], (n, B).
        amplitude: Amplitudes [rad], (K, n, B).
        frequency: Angular frequencies ω [rad/s], broadcast to (K, n, B).
        phase: Phases [rad], broadcast to (K, n, B).
    """

    centre: FloatArray
    amplitude: FloatArray
    frequency: FloatArray
    phase: FloatArray

    def __post_init__(self) -> None:
        for name in ("centre", "amplitude", "frequency", "phase"):
            checked(getattr(self, name), name, ndim=3)

    @staticmethod
    def concatenate(motions: Sequence[Harmonics]) -> Harmonics:
        """Combine the rigs of several motions; sinusoids of amplitude zero make their number equal.

        Args:
            motions: Motions of the same number of joints.

        Returns:
            Motion of all rigs in order.
        """
        most = max(len(motion.amplitude) for motion in motions)

        def wide(x: FloatArray, motion: Harmonics) -> FloatArray:
            """Append zeros up to the largest number of harmonics."""
            full = np.broadcast_to(x, motion.amplitude.shape)
            return np.concatenate([full, np.zeros((most - len(full), *full.shape[1:]))])

        parts = (
            [wide(getattr(motion, name), motion) for motion in motions] for name in ("amplitude", "frequency", "phase")
        )
        centre = np.concatenate([motion.centre for motion in motions], axis=-1)
        return Harmonics(centre, *(np.concatenate(part, axis=-1) for part in parts))

    def at(self, time: float) -> Target:
        """Evaluate the motion."""
        argument = self.frequency * time + self.phase
        sine = self.amplitude * np.sin(argument)
        return Target(
            self.centre + sine.sum(axis=0),
            (self.amplitude * self.frequency * np.cos(argument)).sum(axis=0),
            -(self.frequency**2 * sine).sum(axis=0),
        )

    def over(self, time: FloatArray) -> States:
        """Sample the motion of one rig.

        Args:
            time: Times [s], (N,).

        Returns:
            Angles, velocities and accelerations, (N, n) each.
        """
        instants = replace(self, phase=self.phase + self.frequency * time)  # every instant is one rig
        q, v, a = instants.at(0.0)
        assert a is not None
        return States(q.T, v.T, a.T)


def fit_harmonics(time: ArrayLike, q: ArrayLike, period: float, count: int = 6) -> Harmonics:
    """Fit θ = a0 + Σ a_k cos 2πkt/T + b_k sin 2πkt/T to samples of a periodic motion by least squares.

    Args:
        time: Times of the samples, in any order and spacing [s], (N,).
        q: Angles [rad], (N, n).
        period: Period T [s].
        count: Number of harmonics K.

    Returns:
        Motion of one leg.

    Raises:
        ExoidError: Samples are not finite, differ in number, are too few, or do not cover the period.

    Example:
        >>> t = np.linspace(0.0, 2.0, 40)
        >>> motion = fit_harmonics(t, 0.3 + 0.1 * np.sin(np.pi * t)[:, None], period=2.0, count=3)
        >>> round(float(motion.at(0.5).q[0, 0]), 6)
        0.4
    """
    t, angles = checked(time, "the times [s]"), checked(q, "the angles [rad]", ndim=2)
    if t.ndim != 1 or angles.ndim != 2 or len(t) != len(angles):
        what = f"no motion in times {t.shape} and angles {angles.shape}"
        raise BadArgumentError(what, remedy="give (N,) and (N, n) arrays")
    checked([period, count], "the period [s] and the number of harmonics", above=0.0)
    frequency = 2.0 * np.pi / period * np.arange(1.0, count + 1.0)
    W = np.column_stack([np.ones_like(t), np.cos(np.outer(t, frequency)), np.sin(np.outer(t, frequency))])
    sigma = np.linalg.svd(W, compute_uv=False)
    if len(t) < W.shape[1] or sigma[-1] < 1e-3 * sigma[0]:
        what = f"{len(t)} samples do not determine {count} harmonics of {period:g} s"
        raise BadArgumentError(what, remedy="give samples over a whole period, or fit fewer harmonics")
    found = np.linalg.lstsq(W, angles)[0]
    return from_coefficients(found[0], found[1 : count + 1].T, found[count + 1 :].T, period)


def from_coefficients(mean: FloatArray, cosine: FloatArray, sine: FloatArray, period: float) -> Harmonics:
    """Make the motion of one leg from Fourier coefficients."""
    checked(period, "the period [s]", above=0.0, ndim=0)
    frequency = 2.0 * np.pi / period * np.arange(1.0, cosine.shape[1] + 1.0)[:, None, None]
    phase = np.arctan2(cosine, sine)  # a cos x + b sin x = c sin(x + phase)
    return Harmonics(mean[:, None], np.hypot(cosine, sine).T[..., None], frequency, phase.T[..., None])
