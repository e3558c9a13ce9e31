"""What may change in a leg, and the likelihood ratio of each hypothesis."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.regression.least_squares import RANK
from exoid.torques import TorqueModel

SENSOR_FAULTS = {"torque-scale": "", "angle-offset": " rad", "torque-delay": " s"}
"""Units of the faults of each joint's sensors, in the order of their columns behind those of the parameters."""


class Hypothesis(NamedTuple):
    """Parameters that change together, such as those of a payload."""

    kind: str  # as in `Change`
    joint: str  # joint of the term, or the joint that carries the segment
    basis: FloatArray  # basis of the changes, orthonormal for parameters; columns of faults behind them, (P + 3 n, d)
    parameters: tuple[str, ...]  # names of the parameters; none for a fault


def hypotheses_of(model: TorqueModel) -> tuple[Hypothesis, ...]:
    """List what may change: friction of each joint, load of each segment, other terms and the sensors of each joint."""
    leg, names, n = model.leg, model.names, len(model.leg.joint_names)
    found: dict[tuple[str, str], list[str]] = {}
    for block in model.blocks:
        of_term = type(block.term).__name__.lower()
        kind = "friction" if block.term.friction else {"armature": "inertia"}.get(of_term, of_term)
        kept = [name for name in block.names if name in names]
        if kept:
            found.setdefault((kind, leg.joint_names[block.joints[0]]), []).extend(kept)
    columns = np.eye(len(names) + len(SENSOR_FAULTS) * n)
    hypotheses = [
        Hypothesis(kind, joint, columns[:, [names.index(name) for name in of_kind]], tuple(of_kind))
        for (kind, joint), of_kind in found.items()
    ]
    for k, joint in enumerate(leg.joint_names):
        added = leg.reduction.collect[:, 10 * k : 10 * k + 10]
        U, sizes, _ = np.linalg.svd(added, full_matrices=False)
        basis = columns[:, : len(added)] @ U[:, sizes > RANK * sizes[0]]
        parameters = tuple(name for name, row in zip(names, basis, strict=False) if np.abs(row).max() > RANK)
        hypotheses.append(Hypothesis("load", joint, basis, parameters))
    faults = columns[:, len(names) :]
    for k, kind in enumerate(SENSOR_FAULTS):
        hypotheses += [Hypothesis(kind, joint, faults[:, [k * n + j]], ()) for j, joint in enumerate(leg.joint_names)]
    if n > 1:  # all torques late, as of one bus
        hypotheses.append(Hypothesis("torque-delay", "", faults[:, -n:].sum(axis=1, keepdims=True), ()))
    return tuple(hypotheses)


class Detection(NamedTuple):
    """What the change detection tests."""

    hypotheses: tuple[Hypothesis, ...]  # the hypotheses, C of them
    limits: FloatArray  # thresholds of their statistics over the mean, (C,); infinite for no detection
    dimensions: NDArray[np.intp]  # dimension d of each, (C,)
    # places of the hypotheses of one dimension, and their bases, (c,) and (c, P, d)
    bases: tuple[tuple[NDArray[np.intp], FloatArray], ...]

    @classmethod
    def of(cls, model: TorqueModel, rare: float) -> Detection:
        """Make the hypotheses, and thresholds that one of them crosses with this probability; 0 for no detection."""
        hypotheses = hypotheses_of(model)
        dimensions = np.array([one.basis.shape[1] for one in hypotheses])
        places = [np.flatnonzero(dimensions == d) for d in np.unique(dimensions)]
        bases = tuple((of_one, np.array([hypotheses[k].basis for k in of_one])) for of_one in places)
        # Faults of sensors are looked at only behind an alarm of the others
        looked_at = sum(one.kind not in SENSOR_FAULTS for one in hypotheses)
        limits = np.asarray(scipy.stats.f.isf(rare / looked_at, dimensions, 20.0), dtype=np.float64)  # ν ≥ 20
        return cls(hypotheses, limits, dimensions, bases)

    def statistics(self, score: FloatArray, energy: FloatArray) -> FloatArray:
        """Likelihood ratio of each hypothesis over its dimension, (C,)."""
        found = np.zeros(len(self.hypotheses))
        for places, bases in self.bases:
            used = bases[:, : len(score)]  # without columns of faults these have no energy
            found[places] = ratios_of(score @ used, used.transpose(0, 2, 1) @ (energy @ used)) / used.shape[2]
        return found


def ratios_of(s: FloatArray, E: FloatArray) -> FloatArray:
    """Likelihood ratios sᵀ E⁻¹ s of (c, d) and (c, d, d); zero where a parameter has no energy."""
    size = np.sqrt(np.maximum(np.einsum("cdd->cd", E), 0.0))
    seen = size.all(axis=1)
    size[~seen] = 1.0
    unit = np.eye(E.shape[1])
    ridge = 1e-9 * unit  # a direction without energy of its own says nothing
    scaled = np.where(seen[:, None, None], E / (size[:, :, None] * size[:, None, :]) + ridge, unit)
    y = (s / size)[..., None]
    return np.asarray(seen * (y * np.linalg.solve(scaled, y)).sum(axis=(1, 2)))
