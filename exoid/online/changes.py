"""Change detection: generalised likelihood ratio of innovations in a short window.

Innovations e of rows W follow a change Δβ = B b of a few parameters, e = W B b + noise. With the discounted score
s = Wᵀe and energy E = WᵀW of weighted rows, the likelihood ratio of the best b is

    g = (Bᵀs)ᵀ (Bᵀ E B)⁻¹ (Bᵀs),

which over its mean is F-distributed with (d, ν) degrees of freedom while nothing changes (M. Basseville,
I. V. Nikiforov, Detection of Abrupt Changes, 1993, ch. 7). The mean is that of the last minutes, and contains the
errors of the model that repeat in this motion. The threshold follows from the rate of false alarms.

Values that are known with a covariance P only predict a block with the covariance S = 1 + W P Wᵀ. Its rows are whitened
by S, so that a leg that is still being learned raises no mean and no alarm.

Friction in one direction of motion looks like a load, and a load at rest like an offset. So once a statistic crossed
its threshold, rows are collected, and hypotheses are compared on these. Those
that are not clearly worse than the best are candidates.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.torques import Armature, Offset, Stiffness, Term, TorqueModel

from .rows import Rows
from .settings import Settings
from .state import WARM_UP, Detector

SPANNED = 1e-6
"""Singular values below this part of the largest count as zero."""

KINDS: dict[type[Term], str] = {Offset: "offset", Armature: "inertia", Stiffness: "stiffness"}
"""Kinds of changes of terms that are no friction."""


class Hypothesis(NamedTuple):
    """Parameters that change together, such as those of a payload."""

    kind: str  # as in `Change`
    joint: str  # joint of the term, or the joint that carries the segment
    basis: FloatArray  # orthonormal basis of the changes, (P, d)
    parameters: tuple[str, ...]  # names of the parameters


def hypotheses_of(model: TorqueModel) -> tuple[Hypothesis, ...]:
    """List what may change in a leg: friction of each joint, load of each segment, each other term at each joint."""
    leg, names = model.leg, model.names
    found: dict[tuple[str, str], list[str]] = {}
    for block in model.blocks:
        kind = "friction" if block.term.friction else KINDS.get(type(block.term), type(block.term).__name__.lower())
        kept = [name for name in block.names if name in names]
        if kept:
            found.setdefault((kind, leg.joint_names[block.joints[0]]), []).extend(kept)
    columns = np.eye(len(names))
    hypotheses = [
        Hypothesis(kind, joint, columns[:, [names.index(name) for name in of_kind]], tuple(of_kind))
        for (kind, joint), of_kind in found.items()
    ]
    for k, joint in enumerate(leg.joint_names):
        added = leg.reduction.collect[:, 10 * k : 10 * k + 10]
        U, sizes, _ = np.linalg.svd(added, full_matrices=False)
        basis = np.zeros((len(names), int(np.count_nonzero(sizes > SPANNED * sizes[0]))))
        basis[: len(added)] = U[:, : basis.shape[1]]
        moved = np.abs(basis).max(axis=1) > SPANNED
        parameters = tuple(name for name, is_moved in zip(names, moved, strict=True) if is_moved)
        hypotheses.append(Hypothesis("load", joint, basis, parameters))
    return tuple(hypotheses)


CLEARLY = 30.0
"""Difference of two likelihood ratios that tells hypotheses apart: 2 ln(1/p) for p = 3e-7."""

TORN = 4.0
"""Mean square of residuals over that before a change from which on collected rows are of several changes."""


class Detection(NamedTuple):
    """What the change detection tests."""

    hypotheses: tuple[Hypothesis, ...]  # the hypotheses, C of them
    limits: FloatArray  # thresholds of their statistics over the mean, (C,); infinite for no detection
    dimensions: NDArray[np.intp]  # dimension d of each, (C,)
    # places of the hypotheses of one dimension, and their bases, (c,) and (c, P, d)
    bases: tuple[tuple[NDArray[np.intp], FloatArray], ...]

    @classmethod
    def of(cls, settings: Settings) -> Detection:
        """Make the hypotheses of a leg, and thresholds by the rate of false alarms."""
        hypotheses = hypotheses_of(settings.model)
        dimensions = np.array([one.basis.shape[1] for one in hypotheses])
        places = [np.flatnonzero(dimensions == d) for d in np.unique(dimensions)]
        bases = tuple((of_one, np.array([hypotheses[k].basis for k in of_one])) for of_one in places)
        limits = np.full(len(hypotheses), np.inf)
        if settings.false_alarms > 0.0 and settings.forgetting != "none":
            # at most ten independent looks in a window, of each hypothesis, and ν ≥ 20
            rare = settings.false_alarms * settings.window / (10.0 * 3600.0 * len(hypotheses))
            limits = np.asarray(scipy.stats.f.isf(rare, dimensions, 20.0), dtype=np.float64)
        return cls(hypotheses, limits, dimensions, bases)

    @property
    def on(self) -> bool:
        """Whether changes are detected."""
        return bool(np.isfinite(self.limits).all())

    def statistics(self, score: FloatArray, energy: FloatArray) -> FloatArray:
        """Likelihood ratio of each hypothesis over its dimension, (C,)."""
        found = np.zeros(len(self.hypotheses))
        for places, bases in self.bases:
            found[places] = _ratios(score @ bases, bases.transpose(0, 2, 1) @ (energy @ bases)) / bases.shape[2]
        return found


def _with_uncertainty(s: FloatArray, E: FloatArray, L: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(1 + E P)⁻¹ s and (1 + E P)⁻¹ E with P = L Lᵀ."""
    EL = E @ L
    lost = np.linalg.solve(np.eye(len(L)) + L.T @ EL, EL.T).T  # E L (1 + Lᵀ E L)⁻¹
    return s - lost @ (L.T @ s), E - lost @ EL.T


def _ratios(s: FloatArray, E: FloatArray) -> FloatArray:
    """Likelihood ratios sᵀ E⁻¹ s of (c, d) and (c, d, d); zero where a parameter has no energy."""
    size = np.sqrt(np.maximum(np.einsum("cdd->cd", E), 0.0))
    seen = size.all(axis=1)
    size[~seen] = 1.0
    unit = np.eye(E.shape[1])
    ridge = 1e-9 * unit  # a direction without energy of its own says nothing
    scaled = np.where(seen[:, None, None], E / (size[:, :, None] * size[:, None, :]) + ridge, unit)
    y = (s / size)[..., None]
    return np.asarray(seen * (y * np.linalg.solve(scaled, y)).sum(axis=(1, 2)))


def look(
    settings: Settings,
    detection: Detection,
    before: Detector,
    rows: Rows,
    innovations: FloatArray,
    weights: FloatArray,
    inflation: FloatArray,
    root: FloatArray,
) -> Detector:
    """Look at the innovations of a block while nothing is suspected."""
    window = settings.window
    discount = math.exp(-settings.block_time / window)
    part = max(settings.block_time / (10.0 * window), 1.0 / (1.0 + before.settled))  # weights follow within ten windows
    followed = before.weights + min(1.0, part) * (weights - before.weights)
    precision = followed / np.sqrt(inflation)
    W = (rows.W * precision[:, None]).reshape(-1, settings.count)
    A = W @ root
    whiten = np.linalg.inv(np.linalg.cholesky(np.eye(len(W)) + A @ A.T))
    W, e = whiten @ W, whiten @ (innovations * precision).ravel()
    score = discount * before.score + W.T @ e
    energy = discount * before.energy + W.T @ W
    statistics = (1.0 + discount) * detection.statistics(score, energy)
    duration = before.settled * settings.block_time / window
    above = duration > WARM_UP and bool((statistics > before.mean * detection.limits).any())
    # The mean is that of sixty windows; a statistic enters by three times the mean at most, a change hardly so
    slow = math.exp(-settings.block_time / (60.0 * window))
    level = slow * before.level + np.minimum(statistics, 3.0 * before.mean)
    return before._replace(
        score=score,
        energy=energy,
        level=level,
        looks=slow * before.looks + 1.0,
        crossing=0 if above else -1,
        settled=before.settled + 1,
        weights=followed,
    )


class Verdict(NamedTuple):
    """What the rows since a suspicion say."""

    ratios: FloatArray  # statistic of each hypothesis over its threshold, (C,)
    best: int  # hypothesis that explains most, among those above their threshold; −1 for none
    candidates: tuple[int, ...]  # hypotheses above their threshold that are not clearly worse
    complete: bool  # whether the candidates explain the rows as well as all parameters together
    torn: bool  # whether no parameters explain the rows, which are then of several changes


def judge(detection: Detection, detector: Detector, inflation: FloatArray, root: FloatArray) -> Verdict:
    """Compare the hypotheses on the rows since a suspicion."""
    collected, precision = detector.collected, detector.weights / np.sqrt(inflation)
    table = (collected.R[:-1] * precision[:, None, None]).reshape(-1, collected.R.shape[2])
    W, e = table[:, :-1], table[:, -1] - table[:, :-1] @ detector.values
    score, energy, independent = W.T @ e, W.T @ W, float((collected.rows[:-1] / inflation).sum())
    moving = np.flatnonzero(np.diag(energy) > 0.0)
    everything = float(_ratios(score[None, moving], energy[None][:, moving][:, :, moving])[0])
    score, energy = _with_uncertainty(score, energy, root)
    statistics = detection.statistics(score, energy)
    explained = float(_ratios(score[None, moving], energy[None][:, moving][:, :, moving])[0])
    left = max(float(e @ e) - everything, 0.0) / max(independent - len(moving), 1.0)
    # An F statistic, times what errors of the model raise it by in this motion
    unit = max(1.0, left) * float(detector.mean.mean())
    ratios = statistics / (detector.mean * detection.limits)
    # A further parameter has to bring five times the mean statistic
    worth = np.where(ratios > 1.0, (statistics - 5.0 * unit) * detection.dimensions, -np.inf)
    best = int(np.argmax(worth)) if (ratios > 1.0).any() else -1
    candidates = tuple(np.flatnonzero(worth > worth[best] - CLEARLY * unit).tolist()) if best >= 0 else ()
    lacking = explained - float((statistics * detection.dimensions)[list(candidates)].max(initial=0.0))
    complete = lacking < (CLEARLY + 5.0 * len(moving)) * unit
    return Verdict(ratios, best, candidates, complete, left > TORN and independent > 2.0 * len(moving))
