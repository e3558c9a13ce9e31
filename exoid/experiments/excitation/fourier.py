"""Finite Fourier series that start and stop at rest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.experiments.references import Harmonics, States, from_coefficients
from exoid.tools.numbers import checked


@dataclass(frozen=True, eq=False, repr=False)
class FourierMotion:
    """Periodic motion θ_j(t) = centre_j + Σ_k sine_kj sin kωt + cosine_kj cos kωt, ω = 2π / period."""

    centre: FloatArray  # constant term [rad], (n,)
    sine: FloatArray  # sine coefficients [rad], (K, n)
    cosine: FloatArray  # cosine coefficients [rad], (K, n)
    period: float  # period [s]
    duration: float  # duration [s], a whole number of periods
    pitch: float = 0.0  # tilt of the torso [rad]

    def at(self, time: FloatArray) -> States:
        """Evaluate the motion at N times."""
        k = 2.0 * np.pi / self.period * np.arange(1.0, len(self.sine) + 1.0)
        s, c = np.sin(np.multiply.outer(time, k)), np.cos(np.multiply.outer(time, k))
        return States(
            self.centre + s @ self.sine + c @ self.cosine,
            (k * c) @ self.sine - (k * s) @ self.cosine,
            -(k**2 * s) @ self.sine - (k**2 * c) @ self.cosine,
        )

    def period_samples(self, count: int) -> States:
        """Sample one period evenly."""
        return self.at(np.arange(count) * self.period / count)

    @property
    def reference(self) -> Harmonics:
        """Motion as a reference of one rig."""
        return from_coefficients(self.centre, self.cosine.T, self.sine.T, self.period)


@dataclass(frozen=True, eq=False)
class Basis:
    """Basis of all series of K harmonics that are at rest at t = 0: m functions, of which the first is constant."""

    period: float  # period [s]
    coefficients: FloatArray  # sine and cosine coefficients of each function but the first, (2 K, m − 1)
    position: FloatArray  # samples of one period of the functions, (N, m)
    velocity: FloatArray  # first derivative of the functions [1/s], (N, m)
    acceleration: FloatArray  # second derivative of the functions [1/s²], (N, m)

    @classmethod
    def make(cls, period: float, harmonics: int, samples: int) -> Basis:
        """Compute the functions, scaled so that all reach about the same velocity."""
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
        """Evaluate one period."""
        return States(self.position @ x, self.velocity @ x, self.acceleration @ x)

    def motion(self, x: FloatArray, duration: float, pitch: float) -> FourierMotion:
        """Make the motion of some coefficients."""
        both = self.coefficients @ x[1:]
        half = len(both) // 2
        return FourierMotion(x[0].copy(), both[:half], both[half:], self.period, duration, pitch)


def series(duration: float, rate: float, highest: float, samples: int) -> tuple[float, Basis]:
    """Choose seconds and harmonics of a motion whose period is about 10 s."""
    checked([duration, rate, highest], "duration, rate and highest frequency of a motion", above=0.0)
    if duration * rate > 10**7:
        raise BadArgumentError(
            f"{duration:g} s at {rate:g} Hz are more than {10**7:.0e} samples",
            remedy="plan a shorter motion, or a lower rate: the motion itself needs few samples",
        )
    if rate < samples * highest:
        raise BadArgumentError(
            f"a motion of up to {highest:g} Hz at {rate:g} Hz",
            remedy=f"sample it at {samples * highest:g} Hz at least, or lower the highest frequency",
        )
    seconds = round(duration * rate) / rate
    period = seconds / max(1, round(seconds / 10.0))
    harmonics = min(int(highest * period + 1e-9), 20)
    if harmonics < 3:
        raise BadArgumentError(
            f"{duration:g} s are too short for 3 harmonics up to {highest:g} Hz",
            remedy=f"plan at least {3 / highest:g} s at each torso tilt, or allow higher frequencies",
        )
    return seconds, Basis.make(period, harmonics, samples * harmonics)
