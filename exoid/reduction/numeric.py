"""Numerical reduction: base parameters of any robot by QR with column pivoting of its regressor over random motion.

M. Gautier, "Numerical calculation of the base inertial parameters of robots", J. Robotic Systems 8(4), 1991.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.dynamics import joint_torque_regressor
from exoid.errors import ExoidError

from .reduction import LINK_PARAMETERS, LINK_UNITS, RankDecision, Reduction

THRESHOLD = 1e-9
"""Largest singular value of the unit-column regressor that counts as zero, over the largest one."""

GAP = 10.0
"""Smallest ratio between the values above and below the threshold."""

REMEDY = "round away tiny offsets and angles between joint axes in the URDF"

PREFERENCE = {"Iyy": 8, "Izz": 8, "Ixx": 7, "mcx": 6, "mcy": 6, "mcz": 6, "Ixy": 5, "Ixz": 5, "Iyz": 5, "m": 0}
"""Preference of the parameter that represents a group: inertias and moments rather than masses."""

LONGEST_NAME = 4
"""Largest number of terms in a parameter's name; :attr:`Reduction.collect` has the whole sum."""


def numeric(model: pin.Model, labels: Sequence[str], *, seed: int = 0) -> Reduction:
    """Find the base parameters of a model, each named as a sum such as ``Iyy_shank + 0.185*m_foot``.

    Columns are scaled to unit length times a preference, so that pivoting and names are the same on every machine.
    Parameters that no motion separates are grouped into the first moment or inertia of the link nearest to the base.

    Args:
        model: Model of joints with one degree of freedom.
        labels: Name of the link behind each joint, for the parameter names, (n,).
        seed: Seed of the random motion.

    Returns:
        The reduction, with its :class:`RankDecision`.

    Raises:
        ExoidError: The singular values show no clear gap, so that the rank is ambiguous.
    """
    W = _random_regressor(model, seed)
    scale = np.linalg.norm(W, axis=0)
    nonzero = _nonzero(scale)
    unit = W[:, nonzero] / scale[nonzero]
    rank = _decide_rank(unit, W.shape[1])
    _, R, order = scipy.linalg.qr(unit * _preferences(nonzero, W.shape[1]), mode="economic", pivoting=True)
    r = rank.rank
    kept, grouped = nonzero[order[:r]], nonzero[order[r:]]
    weights = np.zeros((r, W.shape[1]))
    if len(grouped):
        length = scale / _preferences(np.arange(W.shape[1]), W.shape[1])
        ratio = scipy.linalg.solve_triangular(R[:r, :r], R[:r, r:]) * length[grouped] / length[kept][:, None]
        weights[:, grouped] = np.where(np.abs(ratio) > THRESHOLD, ratio, 0.0)
    weights[np.arange(r), kept] = 1.0
    ascending = np.argsort(kept)
    kept, weights = kept[ascending], weights[ascending]
    spread = np.zeros((W.shape[1], r))
    spread[kept, np.arange(r)] = 1.0
    names = tuple(_label(row, int(k), labels) for row, k in zip(weights, kept, strict=True))
    return Reduction(names, tuple(LINK_UNITS[k % 10] for k in kept), weights, spread, rank)


def _random_regressor(model: pin.Model, seed: int) -> FloatArray:
    rng = np.random.default_rng(seed)
    samples = 15 * model.nv + 20
    low = np.maximum(_by_joint(model, model.lowerPositionLimit, -np.pi), -np.pi)
    high = np.minimum(_by_joint(model, model.upperPositionLimit, np.pi), np.pi)
    low, high = np.where(low < high, low, -np.pi), np.where(low < high, high, np.pi)
    q = rng.uniform(low, high, (samples, model.nv))
    v, a = rng.uniform(-3, 3, (2, samples, model.nv))
    return joint_torque_regressor(model, q, v, 3.0 * a).reshape(samples * model.nv, -1)


def _by_joint(model: pin.Model, limits: FloatArray, continuous: float) -> FloatArray:
    """Limits by degree of freedom; a continuous joint gets the given one."""
    joints = [model.joints[j] for j in range(1, model.njoints)]
    return np.array([limits[joint.idx_q] if joint.nq == 1 else continuous for joint in joints])


def _nonzero(scale: FloatArray) -> NDArray[np.intp]:
    """Columns that are not zero, given the length of each."""
    length = scale / scale.max()
    kept = length > THRESHOLD
    if length[~kept].max(initial=0.0) * GAP > length[kept].min():
        raise ExoidError(
            f"the set of parameters that act on the torques is ambiguous (effects of {length[kept].min():.1e} of the "
            f"largest kept, {length[~kept].max():.1e} dropped)",
            remedy=REMEDY,
        )
    return np.flatnonzero(kept)


def _decide_rank(unit: FloatArray, columns: int) -> RankDecision:
    sigma = np.linalg.svd(unit, compute_uv=False)
    sigma = sigma / sigma[0]
    rank = int((sigma > THRESHOLD).sum())
    dropped = float(sigma[rank]) if rank < len(sigma) else 0.0
    decision = RankDecision(rank, columns, float(sigma[rank - 1]), dropped, THRESHOLD)
    if dropped * GAP > sigma[rank - 1]:
        raise ExoidError(f"the number of base parameters is ambiguous ({decision})", remedy=REMEDY)
    return decision


def _preferences(columns: FloatArray | np.ndarray, total: int) -> FloatArray:
    """Weights in (0, 1] that order equivalent columns: by kind of parameter, then from the base outwards."""
    kind = np.array([PREFERENCE[LINK_PARAMETERS[k % 10]] for k in columns])
    return np.asarray((1.0 + kind) / 9.0 * (1.0 - 0.1 * np.asarray(columns) / total))


def _label(row: FloatArray, first: int, labels: Sequence[str]) -> str:
    terms = [first, *(int(k) for k in np.flatnonzero(row) if k != first)]
    text = ""
    for k in terms[:LONGEST_NAME]:
        name = f"{LINK_PARAMETERS[k % 10]}_{labels[k // 10]}"
        size = f"{abs(row[k]):.3g}"
        sign = " - " if row[k] < 0 else " + "
        text += (sign if text else "") + (name if size == "1" else f"{size}*{name}")
    return text if len(terms) <= LONGEST_NAME else f"{text} + …"
