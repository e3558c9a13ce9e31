"""Planned motions: smooth waves, torques (inverse dynamics less what the ground bears), and their execution.

A motion is refused beyond the limits of the joints, and where the machine falls or does not follow.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.experiments.limits import refuse_poses_beyond_limits
from exoid.experiments.references import minimum_jerk
from exoid.leg.link_frames import link_frame
from exoid.leg.torso import TorsoMotion, base_kinematics
from exoid.rig.ground import GroundMotion, GroundPlant, GroundRun, JointGains, Spring, simulate_on_ground

LEAD = 2.0
"""Time in which a machine settles before the log begins [s]."""

KNOTS = 100.0
"""Rate at which motions are planned [Hz]."""


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
    degree: int = 3,
) -> GroundMotion:
    """Add the torques to a planned motion."""
    # The feet bear what the base needs, with the smallest forces, weighted by their shares: w = S Aᵀ (A S Aᵀ)⁻¹ r with
    # the base rows r and the base part A of the transposed Jacobians. Then τ = W_q π + resistances − Σ J_qᵀ w.
    b, rows = plant.leg.base_rows, motion_rows(plant, time, q, base, degree)
    joints = _spline(time, q, degree)
    torque = rows[:, b:] + plant.resistance(q, joints(time, 1)) + plant.armature * joints(time, 2)
    if feet:
        parts = [_bearing(plant, q, base, link, bearing, held=held) for link, bearing in feet.items()]
        if held:
            harness = np.zeros((len(q), 2, b + q.shape[1]))
            harness[:, 0, :2] = np.column_stack([np.cos(base[:, 2]), -np.sin(base[:, 2])])  # forward in the laboratory
            harness[:, 1, 2] = 1.0
            parts.append((harness, np.ones((len(q), 2))))
        J, S = np.concatenate([x for x, _ in parts], axis=1), np.hstack([x for _, x in parts])
        A = J[:, :, :b].transpose(0, 2, 1)
        bearing = np.linalg.solve(np.einsum("nik,nk,njk->nij", A, S, A), rows[:, :b, None])
        wrench = borne * S * np.einsum("nik,ni->nk", A, bearing[..., 0])
        torque = torque - np.einsum("nki,nk->ni", J[:, :, b:], wrench)
    return GroundMotion(time, q, torque, base)


def _spline(time: FloatArray, x: FloatArray, degree: int) -> scipy.interpolate.CubicSpline | scipy.interpolate.BSpline:
    """Spline through samples; of degree 7 its second derivative is that of a smooth motion to 1e-6."""
    return (
        scipy.interpolate.CubicSpline(time, x) if degree == 3 else scipy.interpolate.make_interp_spline(time, x, degree)
    )


def motion_rows(plant: GroundPlant, time: FloatArray, q: FloatArray, base: FloatArray, degree: int = 3) -> FloatArray:
    """Base rows and joint torques of the rigid bodies of a motion without ground, (K, base + n)."""
    joints, torso = _spline(time, q, degree), _spline(time, base, degree)
    change = torso(time, 2)
    # about the origin of the root link
    pitching = TorsoMotion(base[:, 2], torso(time, 1)[:, 2], change[:, 2], change[:, :2])
    base_motion = base_kinematics(pitching, len(time), plant.plane, np.zeros(3))
    return plant.leg.inverse_dynamics(q, joints(time, 1), joints(time, 2), base_motion)


def force_on_one_foot(plant: GroundPlant, time: FloatArray, q: FloatArray, base: FloatArray, link: str) -> FloatArray:
    """Forces forward and up [N] and moment about the middle of its sole [N·m] if one foot bears all, (K, 3)."""
    bearing = Bearing(np.ones_like(time), plant.soles[link].centre)
    J = _bearing(plant, q, base, link, bearing, held=False)[0][:, :, : plant.leg.base_rows]
    rows = motion_rows(plant, time, q, base)[:, : plant.leg.base_rows, None]
    return np.asarray(np.linalg.solve(J.transpose(0, 2, 1), rows)[..., 0])


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
    turned = leg.forward_kinematics(q).rotation[:, frame.body] if frame.body >= 0 else np.eye(3)  # the root link
    rotation = np.broadcast_to(turned @ frame.placement.rotation, (len(q), 3, 3))
    torso = scipy.spatial.transform.Rotation.from_rotvec(np.outer(base[:, 2], -lateral)).as_matrix()
    return np.asarray(torso @ rotation)


def follow(plant: GroundPlant, motion: GroundMotion, gains: JointGains, *, spring: Spring | None = None) -> GroundRun:
    """Let a machine follow a planned motion."""
    refuse_poses_beyond_limits(plant.leg, motion.q)
    run = simulate_on_ground(plant, motion, gains, spring=spring)
    planned = scipy.interpolate.CubicSpline(motion.time, np.column_stack([motion.base[:, 1], motion.q]))(run.time)
    fallen, caught = 0.15, 0.35  # errors of the torso's height [m], and of a joint [rad] where a foot is caught
    far = np.abs(run.position @ plant.plane.up - planned[:, 0]) > fallen
    if far.any():
        raise BadArgumentError(
            f"the machine falls: at {run.time[np.argmax(far)]:.3g} s its torso is {fallen:g} m off the planned height",
            remedy="take smaller or slower motions, or more friction of the ground",
        )
    error = np.abs(run.q - planned[:, 1:])
    if error.max() > caught:
        sample, joint = np.unravel_index(int(np.argmax(error > caught)), error.shape)
        raise BadArgumentError(
            f"{plant.leg.joint_names[joint]} is {caught:g} rad off its reference at {run.time[sample]:.3g} s",
            remedy="take smaller or slower motions; in walking, another period",
        )
    return run


def knots(duration: float) -> FloatArray:
    """Choose the times at which a motion is planned."""
    return np.linspace(-LEAD, duration, round((duration + LEAD) * KNOTS) + 1)


def wave(time: FloatArray, amplitude: float, frequency: float, rng: np.random.Generator) -> FloatArray:
    """Make a sum of sines with random phases that grows from rest."""
    shares, sizes = np.array([(0.37, 0.5), (0.71, 0.45), (1.0, 0.4), (1.63, 0.15)]).T  # of frequency and amplitude
    phases = rng.uniform(0.0, 2.0 * np.pi, len(shares))
    parts = np.sin(2.0 * np.pi * frequency * np.outer(time, shares) + phases)
    return np.asarray(amplitude * rise(time) * (parts @ sizes))


def rise(time: FloatArray) -> FloatArray:
    """Grow from 0 to 1 in 1.5 s, from 0.3 s after a machine begins to settle."""
    return minimum_jerk((time + LEAD - 0.3) / 1.5)
