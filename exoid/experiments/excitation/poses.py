"""Choosing poses to hold: those that together say most about gravity, springs and offsets."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.signals import Poses
from exoid.torques import TorqueModel
from exoid.torso import TorsoMotion

from .limits import MotionLimits
from .noise import TorqueNoise
from .precision import READINGS
from .scales import Scales

CANDIDATES = 400
"""Poses that are drawn for each torso tilt, to choose from."""

DOUBT = 1.0
"""Relative standard deviation of every parameter before anything is measured."""


def choose_poses(
    model: TorqueModel,
    limits: MotionLimits,
    noise: TorqueNoise,
    scales: Scales,
    tilts: FloatArray,
    count: int,
    rng: np.random.Generator,
) -> tuple[Poses, ...]:
    """Choose poses one after the other, each the one that gains most information, ln det (D-optimality).

    Args:
        model: Leg and terms.
        limits: Of angles, holding torques and the foot.
        noise: Of the torque.
        scales: What standard deviations are compared with.
        tilts: Of the torso [rad], (T,).
        count: How many poses at each tilt.
        rng: For the candidates.

    Returns:
        Poses with the torques expected there, of each tilt.

    Raises:
        ExoidError: There are not enough poses within the limits.
    """
    information = np.eye(len(model.names)) / DOUBT**2
    chosen = []
    for tilt in tilts:
        q, columns = _candidates(model, limits, scales, float(tilt), rng)
        if len(q) < count:
            raise ExoidError(
                f"only {len(q)} of {CANDIDATES} poses keep the limits, {count} are asked for",
                where=model.leg.description.name,
                remedy="widen the limits of angle and torque, or ask for fewer poses",
            )
        rows = columns * np.sqrt(READINGS) / np.asarray(noise.std)[:, None]
        gains = np.einsum("kjp,kjq->kpq", rows, rows, optimize=True)
        picked: list[int] = []
        for _ in range(count):
            _, gain = np.linalg.slogdet(information + gains)
            gain[picked] = -np.inf
            picked.append(int(np.argmax(gain)))
            information = information + gains[picked[-1]]
        order = sorted(picked, key=lambda k: tuple(q[k]))  # neighbours after one another
        beta = scales.values / scales.scale
        torso = TorsoMotion(pitch=float(tilt)) if tilt else None
        chosen.append(Poses(q[order], columns[order] @ beta, model.leg.joint_names, torso))
    return tuple(chosen)


def _candidates(
    model: TorqueModel, limits: MotionLimits, scales: Scales, tilt: float, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray]:
    """Draw poses within the limits, and the columns of scaled parameters there, (K, n, P)."""
    q = rng.uniform(limits.lower, limits.upper, (CANDIDATES, len(limits.lower)))
    still = np.zeros_like(q)
    W = model.regressor(q, still, still, TorsoMotion(pitch=tilt) if tilt else None)
    fit = (np.abs(W @ scales.values) <= limits.torque).all(axis=1)
    if limits.clearance is not None:
        fit &= (limits.clearance.room(model.leg, q, tilt) >= 0.0).all(axis=1)
    return q[fit], W[fit] * scales.scale
