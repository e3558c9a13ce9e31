"""Change detection: generalised likelihood ratio of innovations in a short window.

Innovations e of rows W follow a change Δβ = B b of a few parameters, e = W B b + noise. With the discounted score
s = Wᵀe and energy E = WᵀW of weighted rows, the likelihood ratio of the best b is

    g = (Bᵀs)ᵀ (Bᵀ E B)⁻¹ (Bᵀs),

which over its mean is F-distributed with (d, ν) degrees of freedom while nothing changes (M. Basseville,
I. V. Nikiforov, Detection of Abrupt Changes, 1993, ch. 7). The mean is that of the last minutes, and contains the
errors of the model that repeat in this motion. The threshold follows from the rate of false alarms.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray

from .hypotheses import Hypothesis
from .rows import Rows
from .settings import Settings
from .state import Detector

LOOKS = 10.0
"""Independent looks in a window, of each hypothesis, at most."""

DOF = 20.0
"""Degrees of freedom ν of the mean statistic, at least."""

LEVEL = 60.0
"""Time constant of the mean statistic over the window."""

WARM_UP = 20.0
"""Duration of rows before changes are reported, over the window; and"""

SETTLING = 5.0
"""before the mean statistic is followed."""

CONFIRMED = 0.5
"""Time for which a statistic must stay above its threshold, over the window."""

CLIPPED = 3.0
"""A statistic enters its mean by no more than so many times the mean."""

PENALTY = 5.0
"""Evidence that a further parameter of a hypothesis has to bring, over the mean statistic."""

RIDGE = 1e-9
"""Share of its own energy that is added to that of a direction."""


def thresholds(settings: Settings, hypotheses: Sequence[Hypothesis]) -> FloatArray:
    """Thresholds of the statistics over their mean.

    Args:
        settings: Settings with a rate of false alarms.
        hypotheses: The hypotheses, C of them.

    Returns:
        Thresholds, infinite without a rate, (C,).
    """
    if settings.false_alarms == 0.0 or settings.forgetting == "none":
        return np.full(len(hypotheses), np.inf)
    looks = LOOKS * 3600.0 / settings.window * len(hypotheses)
    rare = settings.false_alarms / looks
    return np.array([scipy.stats.f.isf(rare, one.basis.shape[1], DOF) for one in hypotheses])


def looked(
    settings: Settings,
    hypotheses: Sequence[Hypothesis],
    limits: FloatArray,
    before: Detector,
    rows: Rows,
    innovations: FloatArray,
    weights: FloatArray,
) -> tuple[Detector, FloatArray]:
    """Look at the innovations of a block.

    Args:
        settings: Settings.
        hypotheses: The hypotheses, C of them.
        limits: Their thresholds, (C,).
        before: Detector so far.
        rows: Rows of the block.
        innovations: τ − W β of the values before it [N·m], (m, n).
        weights: One over the standard deviation of a row, counted as independent [1/(N·m)], (n,).

    Returns:
        The detector, and each statistic over its mean and threshold, (C,).
    """
    if not rows.used.any():
        return before, np.zeros(len(hypotheses))
    discount = math.exp(-settings.block_time / settings.window)
    W = (rows.W * weights[:, None]).reshape(-1, settings.count)
    score = discount * before.score + W.T @ (innovations * weights).ravel()
    energy = discount * before.energy + W.T @ W
    statistics = (1.0 + discount) * _statistics(hypotheses, score, energy)
    duration = before.settled * settings.block_time / settings.window
    level, looks = before.level, before.looks
    mean = np.maximum(1.0, level / max(looks, 1.0))
    if duration > SETTLING and before.crossing < 0:
        slow = math.exp(-settings.block_time / (LEVEL * settings.window))
        most = CLIPPED * mean if duration > 0.5 * WARM_UP else np.full(len(mean), np.inf)
        level, looks = slow * level + np.minimum(statistics, most), slow * looks + 1.0
        mean = np.maximum(1.0, level / looks)
    ratios = statistics / (mean * limits) if duration > WARM_UP else np.zeros(len(mean))
    above = bool((ratios > 1.0).any())
    crossing = before.crossing + 1 if above else -1
    return Detector(score, energy, level, looks, crossing, before.settled + 1), ratios


def confirmed(settings: Settings, detector: Detector) -> bool:
    """Say whether a statistic has been above its threshold for long enough."""
    return detector.crossing * settings.block_time >= CONFIRMED * settings.window


def most_likely(hypotheses: Sequence[Hypothesis], limits: FloatArray, ratios: FloatArray, detector: Detector) -> int:
    """Choose the hypothesis that explains most of the innovations.

    Args:
        hypotheses: The hypotheses.
        limits: Their thresholds, (C,).
        ratios: Statistics over mean and threshold, (C,).
        detector: The detector.

    Returns:
        Index of the hypothesis.
    """
    dimensions = np.array([one.basis.shape[1] for one in hypotheses])
    mean = np.maximum(1.0, detector.level / max(detector.looks, 1.0))
    energy = ratios * limits * mean * dimensions
    return int(np.argmax(energy - PENALTY * dimensions * mean.mean()))


def _statistics(hypotheses: Sequence[Hypothesis], score: FloatArray, energy: FloatArray) -> FloatArray:
    """Likelihood ratio of each hypothesis over its dimension, (C,)."""
    found = np.zeros(len(hypotheses))
    for k, one in enumerate(hypotheses):
        B = one.basis
        s, E = B.T @ score, B.T @ energy @ B
        size = np.sqrt(np.diag(E))
        if not size.all():
            continue
        scaled = E / np.multiply.outer(size, size) + RIDGE * np.eye(len(E))
        found[k] = float(s / size @ np.linalg.solve(scaled, s / size)) / len(E)
    return found
