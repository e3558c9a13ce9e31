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
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.torques import Armature, Offset, Stiffness, Term, TorqueModel

from .rows import Rows
from .settings import Settings
from .state import Detector

WARM_UP = 20.0
"""Duration of rows before changes are reported, over the window."""

DECISION = 1.5
"""Time over the window for which innovations are summed up, once a statistic crossed its threshold.

Friction in one direction of motion looks like a load. Only when the joint moved both ways do hypotheses differ.
"""

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
            s, E = score @ bases, bases.transpose(0, 2, 1) @ (energy @ bases)
            size = np.sqrt(np.maximum(np.einsum("cdd->cd", E), 0.0))
            seen = size.all(axis=1)
            size[~seen] = 1.0
            unit = np.eye(E.shape[1])
            ridge = 1e-9 * unit  # a direction without energy of its own says nothing
            scaled = np.where(seen[:, None, None], E / (size[:, :, None] * size[:, None, :]) + ridge, unit)
            y = (s / size)[..., None]
            found[places] = seen * (y * np.linalg.solve(scaled, y)).sum(axis=(1, 2)) / E.shape[1]
        return found

    def most_likely(self, ratios: FloatArray, detector: Detector) -> int:
        """Choose the hypothesis that explains most; a further parameter has to bring five times the mean statistic."""
        mean = np.maximum(1.0, detector.level / max(detector.looks, 1.0))
        energy = ratios * self.limits * mean * self.dimensions
        return int(np.argmax(energy - 5.0 * self.dimensions * mean.mean()))


def look(
    settings: Settings,
    detection: Detection,
    before: Detector,
    rows: Rows,
    innovations: FloatArray,
    weights: FloatArray,
    inflation: FloatArray,
) -> tuple[Detector, FloatArray]:
    """Look at the innovations of a block: detector after it, and statistics over their thresholds."""
    suspected, window = before.crossing >= 0, settings.window
    discount = 1.0 if suspected else math.exp(-settings.block_time / window)
    followed = before.weights
    if not suspected:  # weights follow within ten windows
        part = max(settings.block_time / (10.0 * window), 1.0 / (1.0 + before.settled))
        followed = followed + min(1.0, part) * (weights - followed)
    precision = followed / np.sqrt(inflation)
    W = (rows.W * precision[:, None]).reshape(-1, settings.count)
    score = discount * before.score + W.T @ (innovations * precision).ravel()
    energy = discount * before.energy + W.T @ W
    statistics = (1.0 if suspected else 1.0 + discount) * detection.statistics(score, energy)
    duration = before.settled * settings.block_time / window
    level, looks = before.level, before.looks
    mean = np.maximum(1.0, level / max(looks, 1.0))
    if duration > 5.0 and not suspected:
        # the mean is that of sixty windows; a statistic enters by three times the mean at most
        slow = math.exp(-settings.block_time / (60.0 * window))
        most = 3.0 * mean if duration > 0.5 * WARM_UP else np.full(len(mean), np.inf)
        level, looks = slow * level + np.minimum(statistics, most), slow * looks + 1.0
        mean = np.maximum(1.0, level / looks)
    ratios = statistics / (mean * detection.limits) if duration > WARM_UP else np.zeros(len(mean))
    above = bool((ratios > 1.0).any())
    crossing = before.crossing + 1 if suspected else 0 if above else -1
    if crossing * settings.block_time > DECISION * window and not above:
        crossing = -1
    return Detector(score, energy, level, looks, crossing, before.settled + 1, followed), ratios


def confirmed(settings: Settings, detector: Detector) -> bool:
    """Whether innovations were summed up for long enough, and a statistic stayed above its threshold."""
    return detector.crossing * settings.block_time > DECISION * settings.window
