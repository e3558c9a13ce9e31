"""A leg behind Pinocchio's free-flyer joint, with the pose, velocity and acceleration of its base in the world."""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from planar_chains import pinocchios_regressor

from exoid.leg.base_kinematics import BaseKinematics
from exoid.leg.model import configuration


def free_flyer(leg) -> pin.Model:
    """Pinocchio's own model of the URDF behind a free-flyer; other joints are locked as in the leg."""
    full = pin.buildModelFromXML(leg.description.plain, pin.JointModelFreeFlyer())
    positions = np.zeros((1, full.nv))
    for name, value in leg.locked.items():
        positions[0, full.joints[full.getJointId(name)].idx_v] = value
    others = [j for j in range(2, full.njoints) if full.names[j] not in leg.joint_names]
    model = pin.buildReducedModel(full, others, configuration(full, positions)[0])
    assert tuple(model.names)[2:] == leg.joint_names
    return model


@dataclass(frozen=True)
class Flight:
    """Random samples of a base in space, and of joints.

    Attributes:
        model: Pinocchio's model behind a free-flyer.
        q: Configurations, (N, nq).
        v: Velocities, those of the base in its own axes, (N, nv).
        a: Their derivatives, (N, nv).
    """

    model: pin.Model
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray

    @classmethod
    def random(cls, leg, rng, samples=20, *, within_plane=False):
        """Draw samples; within the plane of the leg if that is asked for."""
        model, n = free_flyer(leg), len(leg.joint_names)
        along = np.eye(3) if not within_plane else np.outer(leg.plane.lateral, leg.plane.lateral)
        aside = np.eye(3) if not within_plane else np.eye(3) - along
        joints = rng.uniform(-1.0, 1.0, (3, samples, n)) * np.array([np.pi, 5.0, 20.0])[:, None, None]
        turns = rng.normal(size=(samples, 3)) @ along
        q = configuration(model, np.hstack([np.zeros((samples, 6)), joints[0]]))
        q[:, :3] = rng.normal(size=(samples, 3))
        q[:, 3:7] = [pin.Quaternion(pin.exp3(turn)).coeffs() for turn in turns]
        scales = zip((2.0, 8.0), (3.0, 10.0), joints[1:], strict=True)
        v, a = (
            np.hstack([u * rng.normal(size=(samples, 3)) @ aside, w * rng.normal(size=(samples, 3)) @ along, part])
            for u, w, part in scales
        )
        return cls(model, q, v, a)

    @property
    def rotations(self):
        return np.array([pin.Quaternion(row[3:7]).matrix() for row in self.q])

    @property
    def joints(self):
        """Angles, velocities and accelerations of the joints, as the leg takes them."""
        angles = np.empty_like(self.v[:, 6:])
        for j in range(2, self.model.njoints):
            joint = self.model.joints[j]
            one = self.q[:, joint.idx_q]
            angles[:, j - 2] = one if joint.nq == 1 else np.arctan2(self.q[:, joint.idx_q + 1], one)
        return angles, self.v[:, 6:], self.a[:, 6:]

    @property
    def base(self):
        """What an ideal IMU at the origin of the root link would see."""
        u, omega = self.v[:, :3], self.v[:, 3:6]
        g = np.einsum("nji,j->ni", self.rotations, self.model.gravity.linear)
        return BaseKinematics(omega, self.a[:, 3:6], self.a[:, :3] + np.cross(omega, u) - g, up=self.rotations[:, 2])

    def rows(self):
        """Force and moment on the base about its origin, in its axes, and joint torques, (N, 6 + n)."""
        data = self.model.createData()
        return np.array([pin.rnea(self.model, data, *row).copy() for row in zip(self.q, self.v, self.a, strict=True)])

    def regressor(self):
        return pinocchios_regressor(self.model, self.q, self.v, self.a)


def about_hip(leg, rows):
    """Rows of a base in space as those of a planar one: force forward and up, moment about the hip."""
    force, moment = rows[:, :3], rows[:, 3:6]
    at_hip = moment - np.cross(np.broadcast_to(leg.hip, force.shape), force)
    plane = leg.plane
    return np.column_stack([force @ plane.forward, force @ plane.up, -at_hip @ plane.lateral, rows[:, 6:]])
