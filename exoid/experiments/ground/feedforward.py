"""Torques that a planned motion needs: inverse dynamics less what the ground bears."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.leg.base_kinematics import BaseKinematics
from exoid.leg.link_frames import link_frame
from exoid.leg.reduction.planar import GRAVITY
from exoid.rig.ground import GroundMotion, GroundPlant


@dataclass(frozen=True, eq=False)
class Bearing:
    """Plan of how a foot bears the machine, at K times."""

    share: FloatArray  # share of the foot, 0 to 1, (K,)
    point: FloatArray  # point of the foot at which the ground acts, in the axes of its link [m], (3,) or (K, 3)


def planned_motion(
    plant: GroundPlant,
    time: FloatArray,
    q: FloatArray,
    base: FloatArray,
    feet: Mapping[str, Bearing],
    *,
    held: bool = False,
    borne: float = 1.0,
) -> GroundMotion:
    """Add the torques to a planned motion."""
    # The feet bear what the base needs, with the smallest forces, weighted by their shares: w = S Aᵀ (A S Aᵀ)⁻¹ r with
    # the base rows r and the base part A of the transposed Jacobians. Then τ = W_q π + resistances − Σ J_qᵀ w.
    leg, b = plant.leg, plant.leg.base_rows
    joints, torso = scipy.interpolate.CubicSpline(time, q), scipy.interpolate.CubicSpline(time, base)
    v, a = joints(time, 1), joints(time, 2)
    rows = leg.inverse_dynamics(q, v, a, _base_kinematics(plant, base, torso(time, 1), torso(time, 2)))
    torque = rows[:, b:] + plant.resistance(q, v) + plant.armature * a
    if feet:
        parts = [_bearing(plant, q, base, link, bearing, held=held) for link, bearing in feet.items()]
        if held:
            rail = np.zeros((len(q), 2, b + q.shape[1]))
            rail[:, 0, :2] = np.column_stack([np.cos(base[:, 2]), -np.sin(base[:, 2])])  # forward in the laboratory
            rail[:, 1, 2] = 1.0
            parts.append((rail, np.ones((len(q), 2))))
        J, S = np.concatenate([x for x, _ in parts], axis=1), np.hstack([x for _, x in parts])
        A = J[:, :, :b].transpose(0, 2, 1)
        bearing = np.linalg.solve(np.einsum("nik,nk,njk->nij", A, S, A), rows[:, :b, None])
        wrench = borne * S * np.einsum("nik,ni->nk", A, bearing[..., 0])
        torque = torque - np.einsum("nki,nk->ni", J[:, :, b:], wrench)
    return GroundMotion(time, q, torque, base)


def _bearing(
    plant: GroundPlant, q: FloatArray, base: FloatArray, link: str, bearing: Bearing, *, held: bool
) -> tuple[FloatArray, FloatArray]:
    """Jacobian of a point along the laboratory's forward, up and pitch, (K, 3, base + n), and weights of a foot."""
    leg, plane = plant.leg, plant.plane
    J = leg.frame_jacobian(q, link)
    point = np.broadcast_to(bearing.point, (len(q), 3))
    J[:, :3] += np.cross(J[:, 3:].transpose(0, 2, 1), point[:, None]).transpose(0, 2, 1)
    turn = _turn(plant, q, base, link)
    forward, up = (np.einsum("nij,i->nj", turn, axis) for axis in (plane.forward, plane.up))
    rows = [np.einsum("ni,nij->nj", forward, J[:, :3]), np.einsum("ni,nij->nj", up, J[:, :3])]
    lateral = np.einsum("nij,i->nj", turn, -plane.lateral)
    rows.append(np.einsum("ni,nij->nj", lateral, J[:, 3:]))
    # forces and moments are compared by an arm of 0.1 m; feet bear no forward force or moment if something else does
    scale = np.array([1e-6, 1.0, 1e-6 * 0.1**2] if held else [1.0, 1.0, 0.1**2])
    return np.stack(rows, axis=1), bearing.share[:, None] * scale


def _turn(plant: GroundPlant, q: FloatArray, base: FloatArray, link: str) -> FloatArray:
    """Axes of a foot in the laboratory, as columns, (K, 3, 3)."""
    leg, lateral = plant.leg, plant.plane.lateral
    frame = link_frame(leg.model, leg.description, link)
    rotation = leg.forward_kinematics(q).rotation[:, frame.body] @ frame.placement.rotation
    torso = scipy.spatial.transform.Rotation.from_rotvec(np.outer(base[:, 2], -lateral)).as_matrix()
    return np.asarray(torso @ rotation)


def _base_kinematics(plant: GroundPlant, base: FloatArray, rate: FloatArray, change: FloatArray) -> BaseKinematics:
    """Motion of the torso in its own axes."""
    plane, pitch = plant.plane, base[:, 2]
    force = (change[:, 0] + 1j * (change[:, 1] + GRAVITY)) * np.exp(-1j * pitch)
    return BaseKinematics(
        np.outer(rate[:, 2], -plane.lateral),
        np.outer(change[:, 2], -plane.lateral),
        np.outer(force.real, plane.forward) + np.outer(force.imag, plane.up),
    )
