"""Choice of static poses that are most informative on gravity, springs and offsets."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.torso import TorsoMotion
from exoid.signals import Poses
from exoid.torques import TorqueModel

from .limits import MotionLimits
from .precision import READINGS
from .scales import Scales, TorqueNoise


def choose_poses(
    model: TorqueModel,
    limits: MotionLimits,
    noise: TorqueNoise,
    scales: Scales,
    tilts: FloatArray,
    count: int,
    rng: np.random.Generator,
) -> tuple[Poses, ...]:
    """Choose poses greedily: each maximises ln det of the information so far (D-optimality)."""
    information = np.eye(len(model.names))  # before the poses every parameter is known to its own scale
    chosen = []
    for tilt in tilts:
        q, columns = _candidates(model, limits, scales, float(tilt), rng)
        if len(q) < count:
            raise BadArgumentError(
                f"only {len(q)} of 400 poses are within the limits, {count} are requested",
                where=model.leg.description.name,
                remedy="widen the limits of angle and torque, or request fewer poses",
            )
        rows = columns * np.sqrt(READINGS) / np.asarray(noise.std)[:, None]
        gains = np.einsum("kjp,kjq->kpq", rows, rows, optimize=True)
        picked: list[int] = []
        for _ in range(count):
            _, gain = np.linalg.slogdet(information + gains)
            gain[picked] = -np.inf
            picked.append(int(np.argmax(gain)))
            information = information + gains[picked[-1]]
        order = sorted(picked, key=lambda k: tuple(q[k]))  # neighbours in sequence
        beta = scales.expected / scales.scale
        torso = TorsoMotion(pitch=float(tilt)) if tilt else None
        chosen.append(Poses(q[order], columns[order] @ beta, model.leg.joint_names, torso))
    return tuple(chosen)


def _candidates(
    model: TorqueModel, limits: MotionLimits, scales: Scales, tilt: float, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray]:
    """Draw poses within the limits; return them and the regressor of scaled parameters, (K, n, P)."""
    q = rng.uniform(limits.lower, limits.upper, (400, len(limits.lower)))
    still = np.zeros_like(q)
    W = model.regressor(q, still, still, TorsoMotion(pitch=tilt) if tilt else None)
    fit = (np.abs(W @ scales.expected) <= limits.torque).all(axis=1)
    return q[fit], W[fit] * scales.scale
