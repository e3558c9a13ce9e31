"""Torques that a planned motion needs: inverse dynamics less what the ground bears."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.interpolate import CubicSpline

from exoid._typing import FloatArray
from exoid.reduction import GRAVITY
from exoid.base_kinematics import BaseKinematics
from exoid.rig.ground import GroundMotion, GroundPlant

MOMENT_ARM = 0.1
"""Length by which forces and moments are compared where several feet bear the machine [m]."""


def planned_motion(
    plant: GroundPlant,
    time: FloatArray,
    q: FloatArray,
    base: FloatArray,
    shares: Mapping[str, FloatArray] | None = None,
    *,
    rail: bool = False,
) -> GroundMotion:
    """Add the torques to a planned motion.

    The feet bear what the base needs, with the smallest forces, weighted by shares:
    w = S Aᵀ (A S Aᵀ)⁻¹ r with the base rows r and the base part A of the transposed Jacobians. Then
    τ = W_q π + resistances − Σ J_qᵀ w.

    Args:
        plant: The machine.
        time: Times [s], (K,).
        q: Joint angles [rad], (K, n).
        base: Position forward and up [m] and pitch [rad] of the root link's origin, (K, 3).
        shares: Share of each foot in bearing the machine, 0 to 1, (K,); None if the torso is held.
        rail: Whether a rail bears the force forward and the moment of the torso.

    Returns:
        The motion with its torques.
    """
    leg, b = plant.leg, plant.leg.base_rows
    joints, torso = CubicSpline(time, q), CubicSpline(time, base)
    v, a = joints(time, 1), joints(time, 2)
    rows = leg.inverse_dynamics(q, v, a, _base_kinematics(plant, base, torso(time, 1), torso(time, 2)))
    torque = rows[:, b:] + plant.resistance(q, v) + plant.armature * a
    if shares:
        jacobians = [leg.frame_jacobian(q, link, plant.soles[link].centre)[:, [0, 2, 4]] for link in shares]
        weights = [np.column_stack([share, share, MOMENT_ARM**2 * share]) for share in shares.values()]
        if rail:
            held = np.zeros((len(q), 2, b + q.shape[1]))
            held[:, 0, 0], held[:, 1, 2] = 1.0, 1.0
            jacobians = [*jacobians, held]
            weights = [w * [1e-6, 1.0, 1e-6] for w in weights] + [np.ones((len(q), 2))]
        J, S = np.concatenate(jacobians, axis=1), np.hstack(weights)
        A = J[:, :, :b].transpose(0, 2, 1)
        bearing = np.linalg.solve(np.einsum("nik,nk,njk->nij", A, S, A), rows[:, :b, None])
        wrench = S * np.einsum("nik,ni->nk", A, bearing[..., 0])
        torque = torque - np.einsum("nki,nk->ni", J[:, :, b:], wrench)
    return GroundMotion(time, q, torque, base)


def _base_kinematics(plant: GroundPlant, base: FloatArray, rate: FloatArray, change: FloatArray) -> BaseKinematics:
    """Motion of the torso in its own axes."""
    plane, pitch = plant.plane, base[:, 2]
    force = (change[:, 0] + 1j * (change[:, 1] + GRAVITY)) * np.exp(-1j * pitch)
    return BaseKinematics(
        np.outer(rate[:, 2], -plane.lateral),
        np.outer(change[:, 2], -plane.lateral),
        np.outer(force.real, plane.forward) + np.outer(force.imag, plane.up),
    )
