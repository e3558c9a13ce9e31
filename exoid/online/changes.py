"""Change detection: generalised likelihood ratio of innovations in a short window.

Innovations e of rows W follow a change Δβ = B b of a few parameters, e = W B b + noise. With the discounted score
s = Wᵀe and energy E = WᵀW of weighted rows, the likelihood ratio of the best b is

    g = (Bᵀs)ᵀ (Bᵀ E B)⁻¹ (Bᵀs),

which over its mean is F-distributed with (d, ν) degrees of freedom while nothing changes (Basseville and Nikiforov
1993, ch. 7). The mean is that of the last minutes, and contains the errors of the model that repeat in this motion.

Values that are known with a covariance P only predict a block with the covariance S = 1 + W P Wᵀ. Its rows are whitened
by S, so that a leg that is still being learned raises no mean and no alarm.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from .hypotheses import SENSOR_FAULTS, ratios_of
from .rows import Rows
from .settings import Settings
from .solution import root_of
from .state import WARM_UP, Detector, State

WINDOW, SLIP = 1.0, 10.0
"""Time constant of the discounted sums of innovations, and time for which a suspicion may be a jump of an angle [s]."""

TORN, BENT = 4.0, 0.01
"""Collected rows are of several changes once their mean squared residual is so many times that before the change, and
this part of what changed: what the low-pass bends and the encoder rounds grows with a load, to a tenth of it."""


def look(settings: Settings, state: State, rows: Rows) -> Detector:
    """Look at the innovations of a block while nothing is suspected."""
    before, detection, inflation = state.detector, settings.detection, state.correlation.inflation
    discount = math.exp(-settings.block_time / WINDOW)
    part = max(settings.block_time / (10.0 * WINDOW), 1.0 / (1.0 + before.settled))  # weights follow within ten windows
    followed = before.weights + min(1.0, part) * (state.weights - before.weights)
    precision = followed / np.sqrt(inflation)
    W = (rows.W * precision[:, None]).reshape(-1, settings.count)
    A = W @ root_of(settings, state)
    whiten = np.linalg.inv(np.linalg.cholesky(np.eye(len(W)) + A @ A.T))
    W, e = whiten @ W, whiten @ ((rows.tau - rows.W @ state.values) * precision).ravel()
    score = discount * before.score + W.T @ e
    energy = discount * before.energy + W.T @ W
    statistics = (1.0 + discount) * detection.statistics(score, energy)
    above = before.settled * settings.block_time > WARM_UP and bool((statistics > before.mean * detection.limits).any())
    # The mean is that of sixty windows; a statistic enters by three times the mean at most, a change hardly so
    slow = math.exp(-settings.block_time / (60.0 * WINDOW))
    level = slow * before.level + np.minimum(statistics, 3.0 * before.mean)
    after = before._replace(score=score, energy=energy, level=level, weights=followed)
    return after._replace(looks=slow * before.looks + 1.0, crossing=0 if above else -1, settled=before.settled + 1)


class Verdict(NamedTuple):
    """What the rows since a suspicion say."""

    best: int  # hypothesis that explains most, among those above their threshold; −1 for none
    ratio: float  # its statistic over its threshold
    size: float  # its most likely size if it is a fault of a sensor; NaN for others
    candidates: tuple[int, ...]  # hypotheses above their threshold that are not clearly worse
    complete: bool  # whether the candidates explain the rows as well as all parameters together
    torn: bool  # whether no parameters explain the rows, which are then of several changes


def judge(settings: Settings, state: State) -> Verdict:
    """Compare the hypotheses on the rows since a suspicion."""
    detection, detector, inflation = settings.detection, state.detector, state.correlation.inflation
    faults = [k for k, one in enumerate(detection.hypotheses) if one.kind in SENSOR_FAULTS]
    collected, precision = detector.collected, detector.weights / np.sqrt(inflation)
    table, count = (collected.R[:-1] * precision[:, None, None]).reshape(-1, collected.R.shape[2]), settings.count
    W, e = np.delete(table, count, axis=1), table[:, count] - table[:, :count] @ detector.values
    score, energy, independent = W.T @ e, W.T @ W, float((collected.rows[:-1] / inflation).sum())
    moving = np.flatnonzero(np.diag(energy)[:count] > 0.0)
    # What all parameters explain together with the fault that fits best
    bases = np.array([np.hstack([np.eye(len(W.T))[:, moving], detection.hypotheses[k].basis]) for k in faults])
    everything = float(ratios_of(score @ bases, bases.transpose(0, 2, 1) @ (energy @ bases)).max())
    before = state._replace(weights=detector.weights, information=state.checkpoints[-1])
    # (1 + E P)⁻¹ s and (1 + E P)⁻¹ E with the covariance P = L Lᵀ of what was known before
    L = np.zeros((len(energy), count))
    L[:count] = root_of(settings, before)
    EL = energy @ L
    lost = np.linalg.solve(np.eye(count) + L.T @ EL, EL.T).T
    score, energy = score - lost @ (L.T @ score), energy - lost @ EL.T
    statistics = detection.statistics(score, energy)
    explained = float(ratios_of(score[None, moving], energy[None][:, moving][:, :, moving])[0])
    changed = float(e @ e)
    left = max(changed - everything, 0.0) / max(independent - len(moving), 1.0)
    # An F statistic, times what errors of the model raise it by in this motion
    mean = detector.mean.copy()
    mean[faults] = np.delete(mean, faults).mean()  # while nothing is suspected they are not looked at
    unit = max(1.0, left) * float(mean.mean())
    ratios = statistics / (mean * detection.limits)
    # A further parameter has to bring five times the mean statistic
    worth = np.where(ratios > 1.0, (statistics - 5.0 * unit) * detection.dimensions, -np.inf)
    best = int(np.argmax(worth)) if (ratios > 1.0).any() else -1
    clearly = 30.0  # difference of two likelihood ratios that tells hypotheses apart: 2 ln(1/p) for p = 3e-7
    candidates = tuple(np.flatnonzero(worth > worth[best] - clearly * unit).tolist()) if best >= 0 else ()
    if best >= 0:  # what follows a slip of an encoder may be the slip
        recent = state.samples - detector.crossing * settings.block - state.slips < SLIP * settings.rate
        candidates = tuple(sorted({*candidates, *np.array(faults)[settings.n : 2 * settings.n][recent].tolist()}))
    lacking = explained - float((statistics * detection.dimensions)[list(candidates)].max(initial=0.0))
    complete = lacking < (clearly + 5.0 * len(moving)) * unit
    torn = left > TORN and changed - everything > BENT * changed and independent > 2.0 * len(moving)
    column = detection.hypotheses[best].basis[:, 0]
    size = float(score @ column / (column @ energy @ column)) if best in faults else math.nan
    return Verdict(best, float(ratios[best]), size, candidates, complete, torn)
