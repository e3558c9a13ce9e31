"""Postures of a planar machine: joint angles that put its soles where they should be, and its centre of mass."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from exoid._typing import ComplexArray, FloatArray
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.leg.link_frames import link_frame
from exoid.rig.ground import GroundPlant


@dataclass(frozen=True, eq=False)
class PlanarLeg:
    """Leg of three joints in the plane, where a vector (forward, up) is the complex number x + i z."""

    # Angles are positive about −lateral, so that a body that turns by φ multiplies its vectors by e^{iφ}.

    foot: str  # link of the foot
    joints: slice  # place of its joints among all joints
    hip: complex  # place of the hip in the axes of the root link [m]
    thigh: complex  # vector from hip to knee at the zero pose [m]
    shank: complex  # vector from knee to ankle at the zero pose [m]
    sole: ComplexArray  # vectors from the ankle to the points of the sole at the zero pose [m], (K,)
    signs: FloatArray  # signs of the joint axes, (3,)
    knee: float  # sign of the knee angle of a leg that can walk

    def angles(self, base: FloatArray, centre: ComplexArray, tilt: FloatArray) -> FloatArray:
        """Find the joint angles that put the sole at a place."""
        pitch = base[:, 2]
        ankle = centre - np.exp(1j * tilt) * self.sole.mean()
        way = ankle - (base[:, 0] + 1j * base[:, 1] + np.exp(1j * pitch) * self.hip)
        upper, lower, bends = abs(self.thigh), abs(self.shank), self.signs[1] * self.knee
        cosine = (np.abs(way) ** 2 - upper**2 - lower**2) / (2.0 * upper * lower)
        if not (np.abs(cosine) < 1.0).all():
            raise BadArgumentError(
                f"{self.foot} is up to {np.abs(way).max():.3g} m from the hip, a leg of {upper + lower:.3g} m",
                remedy="lower the torso or the seat, or take smaller steps and shifts",
            )
        fold = np.arccos(cosine)  # of the knee
        ahead = np.arctan2(lower * np.sin(fold), upper + lower * np.cos(fold))  # the thigh, of the way to the ankle
        thigh = np.angle(way) - bends * ahead - np.angle(self.thigh)
        shank = thigh + bends * fold + np.angle(self.thigh) - np.angle(self.shank)
        turns = np.column_stack([thigh - pitch, shank - thigh, tilt - shank])
        return np.asarray(self.signs * np.angle(np.exp(1j * turns)))

    def flexion(self, hip: float, knee: float, ankle: float) -> FloatArray:
        """Convert flexion to joint angles."""
        return np.array([self.signs[0] * hip, self.knee * knee, self.signs[2] * ankle])

    def points(self, base: FloatArray, q: FloatArray) -> ComplexArray:
        """Locate the points of the sole."""
        turns = base[:, 2:] + np.cumsum(self.signs * q[:, self.joints], axis=1)
        thigh, shank, foot = np.exp(1j * turns).T
        hip = base[:, 0] + 1j * base[:, 1] + np.exp(1j * base[:, 2]) * self.hip
        ankle = hip + thigh * self.thigh + shank * self.shank
        return np.asarray(ankle[:, None] + foot[:, None] * self.sole)


def planar_legs(plant: GroundPlant) -> tuple[PlanarLeg, ...]:
    """Read the legs of a machine."""
    leg, forward_up, legs = plant.leg, plant.plane.forward + 1j * plant.plane.up, list[PlanarLeg]()
    data = leg.model.createData()
    pin.forwardKinematics(leg.model, data, pin.neutral(leg.model))
    for limb in leg.limbs:
        joints = range(limb.joints.start, limb.joints.stop)
        feet = [link for link in plant.soles if link_frame(leg.model, leg.description, link).body in joints]
        if len(joints) != 3 or len(feet) != 1:
            raise NotSupportedError(
                f"the leg with {', '.join(leg.joint_names[limb.joints])} has {len(feet)} soles",
                where=leg.description.name,
                remedy="scenarios are made for legs with hip, knee, ankle and one sole",
            )
        body, placement = link_frame(leg.model, leg.description, feet[0])
        foot = data.oMi[body + 1] * placement
        sole = np.array([foot.act(point) for point in plant.soles[feet[0]].points]) @ forward_up
        hip, knee, ankle = (complex(data.oMi[j + 1].translation @ forward_up) for j in joints)
        middle = float(leg.limits.lower[joints[1]] + leg.limits.upper[joints[1]])
        bends = float(np.sign(middle)) if np.isfinite(middle) and middle else -1.0
        own = feet[0], limb.joints, hip, knee - hip, ankle - knee, sole - ankle, limb.chain.signs, bends
        legs.append(PlanarLeg(*own))
    if not legs:
        raise NotSupportedError(
            "the machine is not planar", where=leg.description.name, remedy="use legs in parallel planes"
        )
    return tuple(legs)


def stand_flat(q: FloatArray, legs: Sequence[PlanarLeg], base: FloatArray) -> None:
    """Set the angles of legs that stand flat, with the middle of their soles at the origin."""
    for leg in legs:
        q[:, leg.joints] = leg.angles(base, np.zeros(len(base), dtype=np.complex128), np.zeros(len(base)))


def centre_of_mass(plant: GroundPlant, base: FloatArray, q: FloatArray) -> FloatArray:
    """Locate the centre of mass."""
    model, plane = plant.leg.model, plant.plane
    rotation, translation = plant.leg.forward_kinematics(q)
    bodies = [model.inertias[j] for j in range(1, model.njoints)]
    levers = np.array([body.lever for body in bodies])
    masses = np.array([body.mass for body in bodies])
    moment = np.einsum("j,njk->nk", masses, np.einsum("njkl,jl->njk", rotation, levers) + translation)
    moment = moment + model.inertias[0].mass * model.inertias[0].lever
    within = moment @ (plane.forward + 1j * plane.up) / (masses.sum() + model.inertias[0].mass)
    return np.asarray(base[:, 0] + (np.exp(1j * base[:, 2]) * within).real)


def total_mass(plant: GroundPlant) -> float:
    """Sum up the masses of all bodies."""
    return float(sum(body.mass for body in plant.leg.model.inertias))
