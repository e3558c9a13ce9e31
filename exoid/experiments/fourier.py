"""Fourier series fitted to measured angles, with exact derivatives."""

from __future__ import annotations

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError

from .references import Harmonics


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
    t, angles = np.asarray(time, dtype=np.float64), np.asarray(q, dtype=np.float64)
    if t.ndim != 1 or angles.ndim != 2 or len(t) != len(angles) or not np.isfinite(t).all() * np.isfinite(angles).all():
        raise ExoidError(
            f"no motion in times {t.shape} and angles {angles.shape}", remedy="give finite (N,) and (N, n) arrays"
        )
    if not 0.0 < period < np.inf or count < 1:
        raise ExoidError(f"{count} harmonics of a period of {period:g} s", remedy="give a positive period and count")
    frequency = 2.0 * np.pi / period * np.arange(1.0, count + 1.0)
    W = np.column_stack([np.ones_like(t), np.cos(np.outer(t, frequency)), np.sin(np.outer(t, frequency))])
    sigma = np.linalg.svd(W, compute_uv=False)
    if len(t) < W.shape[1] or sigma[-1] < 1e-3 * sigma[0]:
        raise ExoidError(
            f"{len(t)} samples do not determine {count} harmonics of {period:g} s",
            remedy="give samples over a whole period, or fit fewer harmonics",
        )
    found = np.linalg.lstsq(W, angles)[0]
    return from_coefficients(found[0], found[1 : count + 1].T, found[count + 1 :].T, period)


def from_coefficients(mean: FloatArray, cosine: FloatArray, sine: FloatArray, period: float) -> Harmonics:
    """Make the motion of one leg from Fourier coefficients."""
    frequency = 2.0 * np.pi / period * np.arange(1.0, cosine.shape[1] + 1.0)[:, None, None]
    phase = np.arctan2(cosine, sine)  # a cos x + b sin x = c sin(x + phase)
    return Harmonics(mean[:, None], np.hypot(cosine, sine).T[..., None], frequency, phase.T[..., None])
