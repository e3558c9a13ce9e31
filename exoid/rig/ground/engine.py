"""MuJoCo with one machine on flat ground: its state, its steps, its forces, and the spring that may hold its torso."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.leg.link_frames import link_frame
from exoid.tools.extras import require_mujoco

from .motion import JointTargets, Spring
from .mujoco_model import build_mujoco_model, geometry_name
from .plant import GroundPlant


class Pose(NamedTuple):
    """Place of a link in the laboratory."""

    position: FloatArray  # its origin [m], (3,)
    rotation: FloatArray  # its axes as columns, (3, 3)


class Engine:
    """Machine on flat ground; the laboratory has z up and the ground at z = 0."""

    # The step is a leapfrog: v_{k+½} = v_{k−½} + dt a_k, q_{k+1} = q_k + dt v_{k+½}. `begin` computes what depends on
    # q_k and on v_k = v_{k−½} + ½ dt a_{k−1}, then forces are applied, and `finish` computes the acceleration a_k and
    # the contact forces, and advances the state. Friction and Coriolis forces of v_{k−½} would be half a step late.
    # base: Number of velocities of the base, 3 or 6.
    # q: Joint angles [rad], (n,), a view.
    # v: Joint velocities [rad/s], (n,), a view.
    # rate: Velocities of base and joints, (base + n,), a view. Of a base in space: linear in the laboratory,
    # angular in its own axes.
    # acceleration: Accelerations of the last step in the coordinates of `rate`, (base + n,), a view.
    # spheres: Place of the points of each sole among all of them.
    # between: Velocities of half a step before those of `rate` while `begin` has been called, and `finish` not yet.
    # applied: Forces that are applied in this step, in these coordinates, a view.

    def __init__(self, plant: GroundPlant, step: float) -> None:
        self._mujoco = require_mujoco()
        self.plant, self.base = plant, 3 if plant.is_planar else 6
        self.model = build_mujoco_model(plant, step)
        self.data = self._mujoco.MjData(self.model)
        n = len(plant.leg.joint_names)
        self.q, self.v = self.data.qpos[-n:], self.data.qvel[-n:]
        self.rate, self.acceleration, self.applied = self.data.qvel, self.data.qacc, self.data.qfrc_applied
        self.between = self.rate.copy()
        frames = [link_frame(plant.leg.model, plant.leg.description, link) for link in (plant.root_link, *plant.soles)]
        self._bodies = np.array([frame.body + 2 for frame in frames])  # body 0 is the laboratory, body 1 the root link
        self._offsets = np.array([frame.placement.translation for frame in frames])
        self._turns = np.array([frame.placement.rotation for frame in frames])
        counts = np.cumsum([0, *(len(sole.points) for sole in plant.soles.values())])
        self.spheres = {link: slice(*ends) for link, ends in zip(plant.soles, pairwise(counts), strict=True)}
        # number of each sphere among all of them, by its number among MuJoCo's geometries; −1 for ground and blocks
        self._numbers = np.full(self.model.ngeom, -1)
        for link, own in self.spheres.items():
            for k, number in enumerate(range(own.start, own.stop)):
                self._numbers[self.model.geom(geometry_name(link, k)).id] = number

    def place(self, q: FloatArray, base: FloatArray) -> None:
        """Set the state at rest."""
        data, plane = self.data, self.plant.plane
        self._mujoco.mj_resetData(self.model, data)
        if self.plant.is_planar:
            data.qpos[:3] = base
        else:
            data.qpos[:3] = base[0] * plane.forward + base[1] * plane.up
            data.qpos[3:7] = _quaternion(-plane.lateral, base[2])
        self.q[:] = q

    def begin(self) -> None:
        """Compute what depends on positions and velocities."""
        self.between[:] = self.rate
        self.rate += 0.5 * self.model.opt.timestep * self.acceleration
        self._mujoco.mj_step1(self.model, self.data)

    def finish(self) -> None:
        """Compute accelerations and contact forces, and advance the state."""
        self.rate[:] = self.between
        self._mujoco.mj_step2(self.model, self.data)

    @property
    def torso(self) -> Pose:
        """Place of the root link at the beginning of the step."""
        return Pose(self.data.xpos[1], self.data.xmat[1].reshape(3, 3))

    def twist(self) -> FloatArray:
        """Compute the velocity of the root link."""
        out = np.zeros(6)
        self._mujoco.mj_objectVelocity(self.model, self.data, self._mujoco.mjtObj.mjOBJ_XBODY, 1, out, 0)
        return out

    def placements(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Locate the root link and the links with soles at the beginning of the step."""
        data = self.data
        turns = data.xmat[self._bodies].reshape(-1, 3, 3)
        origin = data.xpos[self._bodies] + np.einsum("fij,fj->fi", turns, self._offsets)
        twist = data.cvel[self._bodies]  # about the centre of mass
        arm = origin - data.subtree_com[1]
        twist[:, 3:] += _cross(twist[:, :3], arm)
        return origin, turns @ self._turns, twist

    def push(self, force: FloatArray, moment: FloatArray, point: FloatArray) -> FloatArray:
        """Convert a force on the torso to the coordinates of :attr:`applied`."""
        out = np.zeros(len(self.rate))
        self._mujoco.mj_applyFT(self.model, self.data, force, moment, point, 1, out)
        return out

    def loads(self) -> FloatArray:
        """Read the vertical force on each point of the soles in the step, (K,)."""
        contact = self.data.contact
        force = np.zeros(sum(len(sole.points) for sole in self.plant.soles.values()))
        own = contact.efc_address >= 0
        if own.any():
            local = self.data.efc_force[contact.efc_address[own][:, None] + np.arange(3)]
            pairs = self._numbers[contact.geom[own]]
            # of two geometries the one whose kind comes first in MuJoCo is the first: the ground, but not a block
            signs = np.where(pairs[:, 1] >= 0, 1.0, -1.0)
            up = contact.frame[own].reshape(-1, 3, 3)[:, :, 2]
            np.add.at(force, pairs.max(axis=1), signs * np.einsum("kj,kj->k", local, up))
        return force

    def ground(self) -> tuple[FloatArray, FloatArray]:
        """Read moment and force on each link with a sole in the step, (F, 6), and the point of the moments, (3,)."""
        self._mujoco.mj_rnePostConstraint(self.model, self.data)
        return self.data.cfrc_ext[self._bodies[1:]], self.data.subtree_com[1].copy()

    def turn_to(self, target: FloatArray) -> FloatArray:
        """Find the rotation from the root link to another orientation."""
        own, inverse, out = self.data.xquat[1], np.zeros(4), np.zeros(3)
        self._mujoco.mju_negQuat(inverse, own)
        turn = np.zeros(4)
        self._mujoco.mju_mulQuat(turn, target, inverse)
        self._mujoco.mju_quat2Vel(out, turn, 1.0)
        return out


class Holder:
    """Spring of a run; `wrench` is its force [N] and moment about the point [N·m] on the torso in the last step."""

    def __init__(self, engine: Engine, spring: Spring, targets: JointTargets) -> None:
        plane, self._point = engine.plant.plane, np.array(spring.point)
        axes = np.array([plane.forward, plane.lateral, plane.up])
        self.spring, self._engine, self.wrench = spring, engine, np.zeros((2, 3))
        self._stiffness, self._damping = (axes.T @ np.diag(x) @ axes for x in (spring.stiffness, spring.damping))
        base, rate = targets.base, targets.base_rate
        turned = scipy.spatial.transform.Rotation.from_rotvec(np.outer(base[:, 2], -plane.lateral)).apply(self._point)
        self._turning = np.outer(rate[:, 2], -plane.lateral)
        self._place = base[:, :2] @ axes[[0, 2]] + turned
        self._speed = rate[:, :2] @ axes[[0, 2]] + np.cross(self._turning, turned)
        self._pitch = base[:, 2]

    def force(self, step: int) -> FloatArray:
        """Compute the force in a step."""
        engine, spring = self._engine, self.spring
        position, rotation = engine.torso
        twist, arm = engine.twist(), rotation @ self._point
        force = self._stiffness @ (self._place[step] - position - arm)
        force += self._damping @ (self._speed[step] - twist[3:] - _cross(twist[np.newaxis, :3], arm[np.newaxis])[0])
        target = _quaternion(-engine.plant.plane.lateral, self._pitch[step])
        moment = spring.turning_stiffness * engine.turn_to(target)
        moment += spring.turning_damping * (self._turning[step] - twist[:3])
        self.wrench = np.array([force, moment])
        return engine.push(force, moment, position + arm)


def _quaternion(axis: FloatArray, angle: float) -> FloatArray:
    """Write a rotation as a quaternion."""
    return np.concatenate([[np.cos(angle / 2)], np.sin(angle / 2) * axis])


def _cross(x: FloatArray, y: FloatArray) -> FloatArray:
    """Cross product of rows, faster than NumPy's on few of them."""
    return x[:, [1, 2, 0]] * y[:, [2, 0, 1]] - x[:, [2, 0, 1]] * y[:, [1, 2, 0]]
