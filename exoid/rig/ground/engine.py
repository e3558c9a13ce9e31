"""MuJoCo with one machine on flat ground: its state, its steps, and the forces that it computes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.link_frames import link_frame
from exoid.reduction import GRAVITY

from .mujoco_model import RAIL_JOINTS, build_mujoco_model, geometry_name, require_mujoco
from .plant import GroundPlant


class Load(NamedTuple):
    """Force on one sole at one step.

    Attributes:
        force: Force of the ground on the foot, in the laboratory [N], (3,).
        moment: Its moment about the origin of the laboratory [N·m], (3,).
        points: Number of points of the sole that bear load.
    """

    force: FloatArray
    moment: FloatArray
    points: int


class Pose(NamedTuple):
    """Place of a link in the laboratory.

    Attributes:
        position: Its origin [m], (3,).
        rotation: Its axes as columns, (3, 3).
    """

    position: FloatArray
    rotation: FloatArray


class Engine:
    """Machine on flat ground; the laboratory has z up and the ground at z = 0.

    A step k begins with positions q_k and velocities v_k. :meth:`begin` computes what depends on them, then forces are
    applied, and :meth:`finish` computes the acceleration a_k and the contact forces, and advances the state.

    Args:
        plant: The machine.
        step: Step of the simulation [s].
        rail: Whether a vertical rail holds the torso of a planar machine: it does not move forward and does not pitch.

    Attributes:
        plant: The machine.
        base: Number of velocities of the base, 3 or 6.
        model: MuJoCo's model.
        data: MuJoCo's state.
        q: Joint angles [rad], (n,), a view.
        v: Joint velocities [rad/s], (n,), a view.
        rate: Velocities of base and joints, (base + n,), a view. Of a base in space: linear in the laboratory, angular
            in its own axes.
        applied: Forces that are applied in this step, in these coordinates, a view.

    Raises:
        ExoidError: MuJoCo is not installed, a body cannot exist, or a machine that is not planar is on a rail.
    """

    def __init__(self, plant: GroundPlant, step: float, *, rail: bool = False) -> None:
        self._mujoco = require_mujoco()
        self.plant, self.base = plant, 3 if plant.is_planar else 6
        self.model = build_mujoco_model(plant, step, rail=rail)
        self.data = self._mujoco.MjData(self.model)
        n = len(plant.leg.joint_names)
        self.q, self.v = self.data.qpos[-n:], self.data.qvel[-n:]
        self.rate, self.applied = self.data.qvel, self.data.qfrc_applied
        self._foot_of = {
            self.model.geom(geometry_name(link, number)).id: link
            for link, sole in plant.soles.items()
            for number in range(len(sole.points))
        }
        frames = {link: link_frame(plant.leg.model, plant.leg.description, link) for link in plant.soles}
        self._bodies = {link: (joint + 2, placement) for link, (joint, placement) in frames.items()}
        self._rows = tuple(k for k, name in enumerate(("forward", "up", "pitch")) if name in RAIL_JOINTS)

    def place(self, q: FloatArray, base: FloatArray) -> None:
        """Set the state at rest.

        Args:
            q: Joint angles [rad], (n,).
            base: Position forward and up [m] and pitch [rad] of the root link's origin, (3,).
        """
        data, plane = self.data, self.plant.plane
        self._mujoco.mj_resetData(self.model, data)
        if self.plant.is_planar:
            data.qpos[:3] = base
        else:
            data.qpos[:3] = base[0] * plane.forward + base[1] * plane.up
            data.qpos[3:7] = quaternion(-plane.lateral, base[2])
        self.q[:] = q

    def begin(self) -> None:
        """Compute what depends on positions and velocities."""
        self._mujoco.mj_step1(self.model, self.data)

    def finish(self) -> None:
        """Compute accelerations and contact forces, and advance the state."""
        self._mujoco.mj_step2(self.model, self.data)

    def pose(self, link: str | None = None) -> Pose:
        """Locate a link at the beginning of the step.

        Args:
            link: Link with a sole; None for the root link.

        Returns:
            Its place.
        """
        body, placement = (1, pin.SE3.Identity()) if link is None else self._bodies[link]
        position, rotation = self.data.xpos[body], self.data.xmat[body].reshape(3, 3)
        return Pose(position + rotation @ placement.translation, rotation @ placement.rotation)

    def twist(self, link: str | None = None) -> FloatArray:
        """Compute the velocity of a link.

        Args:
            link: Link with a sole; None for the root link.

        Returns:
            Angular velocity [rad/s] and velocity of the origin of its body [m/s] in the laboratory, (6,).
        """
        body, out = 1 if link is None else self._bodies[link][0], np.zeros(6)
        self._mujoco.mj_objectVelocity(self.model, self.data, self._mujoco.mjtObj.mjOBJ_XBODY, body, out, 0)
        return out

    def push(self, force: FloatArray, moment: FloatArray, point: FloatArray) -> FloatArray:
        """Convert a force on the torso to the coordinates of :attr:`applied`.

        Args:
            force: Force in the laboratory [N], (3,).
            moment: Moment about the point [N·m], (3,).
            point: Point in the laboratory [m], (3,).

        Returns:
            Generalised force, (base + n,).
        """
        out = np.zeros(len(self.rate))
        self._mujoco.mj_applyFT(self.model, self.data, force, moment, point, 1, out)
        return out

    def base_motion(self, rate: FloatArray, acceleration: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Describe the motion of the base by what an IMU at its origin measures.

        Args:
            rate: Velocities at the beginning of the step, (base + n,).
            acceleration: Accelerations in the step, (base + n,).

        Returns:
            Angular velocity [rad/s], angular acceleration [rad/s²] and specific force [m/s²] in its axes, (3,) each.
        """
        plane, rotation = self.plant.plane, self.pose().rotation
        if self.plant.is_planar:
            linear = acceleration[0] * plane.forward + acceleration[1] * plane.up
            turning = rate[2] * -plane.lateral, acceleration[2] * -plane.lateral
        else:
            linear, turning = acceleration[:3], (rate[3:6], acceleration[3:6])
        force = rotation.T @ (linear + GRAVITY * plane.up)
        return (*turning, force)

    def loads(self) -> dict[str, Load]:
        """Read the contact forces of the step.

        Returns:
            Load of each sole.
        """
        data = self.data
        found = {link: (np.zeros(3), np.zeros(3), [0]) for link in self.plant.soles}
        for contact in data.contact[: data.ncon]:
            if contact.efc_address < 0:
                continue
            local = data.efc_force[contact.efc_address : contact.efc_address + 3]
            force = contact.frame.reshape(3, 3).T @ local  # on the second geometry: the ground is the first
            total, moment, points = found[self._foot_of[contact.geom2]]
            total += force
            moment += np.cross(contact.pos, force)
            points[0] += int(local[0] > 0.0)
        return {link: Load(total, moment, points[0]) for link, (total, moment, points) in found.items()}

    def turn_to(self, target: FloatArray) -> FloatArray:
        """Find the rotation from the root link to another orientation.

        Args:
            target: Quaternion of that orientation (w, x, y, z), (4,).

        Returns:
            Rotation vector in the laboratory [rad], (3,).
        """
        own, inverse, out = self.data.xquat[1], np.zeros(4), np.zeros(3)
        self._mujoco.mju_negQuat(inverse, own)
        turn = np.zeros(4)
        self._mujoco.mju_mulQuat(turn, target, inverse)
        self._mujoco.mju_quat2Vel(out, turn, 1.0)
        return out

    @property
    def has_rail(self) -> bool:
        """Whether a rail holds the torso."""
        return bool(self.model.neq)

    @property
    def rail_wrench(self) -> FloatArray:
        """Force and moment of the rail about the root link's origin in the laboratory [N, N·m], (2, 3)."""
        plane, rail = self.plant.plane, self.rail
        if not self.has_rail:
            return np.zeros((2, 3))
        return np.array([rail[0] * plane.forward + rail[1] * plane.up, -rail[2] * plane.lateral])

    @property
    def rail(self) -> FloatArray:
        """Generalised force of the rail in the step, (base + n,); zero without a rail."""
        out = np.zeros(len(self.rate))
        if self.model.neq:
            out[list(self._rows)] = self.data.efc_force[: self.model.neq]  # equalities are MuJoCo's first constraints
        return out

    @property
    def energy(self) -> float:
        """Kinetic and potential energy at the beginning of the step, rotors and springs of the joints included [J]."""
        self._mujoco.mj_energyPos(self.model, self.data)
        self._mujoco.mj_energyVel(self.model, self.data)
        springs = 0.5 * self.plant.stiffness * self.q**2 + self.plant.constant * self.q
        return float(self.data.energy.sum() + springs.sum())

    @property
    def momentum(self) -> FloatArray:
        """Linear momentum at the beginning of the step [N·s], (3,)."""
        self._mujoco.mj_subtreeVel(self.model, self.data)
        return np.asarray(self.model.body_subtreemass[1] * self.data.subtree_linvel[1])

    @property
    def weight(self) -> float:
        """Weight of the machine [N]."""
        return float(GRAVITY * self.model.body_subtreemass[1])


def quaternion(axis: FloatArray, angle: float) -> FloatArray:
    """Write a rotation as a quaternion.

    Args:
        axis: Axis, (3,).
        angle: Angle [rad].

    Returns:
        Quaternion (w, x, y, z), as MuJoCo has it, (4,).
    """
    return np.concatenate([[np.cos(angle / 2)], np.sin(angle / 2) * axis])
