"""Finite Fourier series that start and stop at rest: the motions that are planned."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.experiments.references import Harmonics

AT_REST = 3
"""Conditions at t = 0 on each joint: no velocity, no acceleration, no jerk."""


class States(NamedTuple):
    """Samples of a motion, (N, n) each.

    Attributes:
        q: Angles [rad].
        v: Velocities [rad/s].
        a: Accelerations [rad/s²].
    """

    q: FloatArray
    v: FloatArray
    a: FloatArray


@dataclass(frozen=True, eq=False)
class FourierMotion:
    """θ_j(t) = centre_j + Σ_k sine_kj sin kωt + cosine_kj cos kωt, ω = 2π / period, repeated for ``duration``.

    Attributes:
        centre: [rad], (n,).
        sine: [rad], (K, n).
        cosine: [rad], (K, n).
        period: [s].
        duration: [s], whole periods, so that it stops as it starts.
        pitch: Tilt of the torso meanwhile [rad].
    """

    centre: FloatArray
    sine: FloatArray
    cosine: FloatArray
    period: float
    duration: float
    pitch: float = 0.0

    def at(self, time: FloatArray) -> States:
        """Angles, velocities and accelerations at some times [s], (N,)."""
        k = 2.0 * np.pi / self.period * np.arange(1.0, len(self.sine) + 1.0)
        s, c = np.sin(np.multiply.outer(time, k)), np.cos(np.multiply.outer(time, k))
        return States(
            self.centre + s @ self.sine + c @ self.cosine,
            (k * c) @ self.sine - (k * s) @ self.cosine,
            -(k**2 * s) @ self.sine - (k**2 * c) @ self.cosine,
        )

    def sampled(self, rate: float) -> tuple[FloatArray, States]:
        """Times [s] at a rate [Hz], both ends included, and the motion then."""
        time = np.arange(round(self.duration * rate) + 1) / rate
        return time, self.at(time)

    def period_samples(self, count: int) -> States:
        """One period in ``count`` even samples."""
        return self.at(np.arange(count) * self.period / count)

    def smaller(self, factor: float) -> FourierMotion:
        """Shrink about the centre."""
        return FourierMotion(
            self.centre, factor * self.sine, factor * self.cosine, self.period, self.duration, self.pitch
        )

    @property
    def reference(self) -> Harmonics:
        """The motion as one rig follows it; c sin(x + φ) = c cos φ sin x + c sin φ cos x."""
        frequency = 2.0 * np.pi / self.period * np.arange(1.0, len(self.sine) + 1.0)
        return Harmonics(
            self.centre[:, None],
            np.hypot(self.sine, self.cosine)[..., None],
            np.broadcast_to(frequency[:, None, None], (*self.sine.shape, 1)),
            np.arctan2(self.cosine, self.sine)[..., None],
        )


@dataclass(frozen=True, eq=False)
class Basis:
    """All series of K harmonics that are at rest at t = 0, as linear combinations of m functions, the first a constant.

    Attributes:
        period: [s].
        coefficients: Sine and cosine coefficients of each function but the first, (2 K, m − 1).
        position: One period of the functions, (N, m).
        velocity: Their first derivative [1/s].
        acceleration: Their second [1/s²].
    """

    period: float
    coefficients: FloatArray
    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray

    @classmethod
    def make(cls, period: float, harmonics: int, samples: int) -> Basis:
        """Make the functions; higher harmonics are scaled down so that all are about equally fast."""
        k = np.arange(1.0, harmonics + 1.0)
        zero = np.zeros(harmonics)
        # in coefficients times k: velocity Σ s_k, acceleration Σ k c_k, jerk Σ k² s_k
        rest = np.array([[*k**0, *zero], [*zero, *k], [*k**2, *zero]])
        free = scipy.linalg.null_space(rest / np.linalg.norm(rest, axis=1, keepdims=True))
        coefficients = free / np.tile(k, 2)[:, None]
        parts = FourierMotion(
            np.zeros(free.shape[1]), coefficients[:harmonics], coefficients[harmonics:], period, period
        ).period_samples(samples)
        ends = (np.ones, np.zeros, np.zeros)
        return cls(
            period,
            coefficients,
            *(np.column_stack([end(samples), part]) for end, part in zip(ends, parts, strict=True)),
        )

    @property
    def count(self) -> int:
        """Number of functions m."""
        return int(self.position.shape[1])

    def states(self, x: FloatArray) -> States:
        """One period of the motion of coefficients x, (m, n)."""
        return States(self.position @ x, self.velocity @ x, self.acceleration @ x)

    def pulled_back(self, gradient: States) -> FloatArray:
        """Gradient by coefficients, (m, n), from that by samples."""
        return np.asarray(
            self.position.T @ gradient.q + self.velocity.T @ gradient.v + self.acceleration.T @ gradient.a
        )

    def motion(self, x: FloatArray, duration: float, pitch: float) -> FourierMotion:
        """Motion of coefficients x, (m, n)."""
        both = self.coefficients @ x[1:]
        half = len(both) // 2
        return FourierMotion(x[0].copy(), both[:half], both[half:], self.period, duration, pitch)
