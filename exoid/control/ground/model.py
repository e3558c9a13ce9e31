"""Model of a machine on the ground, fast at a single sample: inertia, bias forces, and the rows of its contacts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.control.functions.body import from_joint, refuse_backwards
from exoid.control.model import ControlModel, completed
from exoid.errors import NotIdentifiableError, NotSupportedError
from exoid.estimate import Estimate
from exoid.leg.floating_base import free_flyer_model, planar_coordinates
from exoid.leg.leg import Leg
from exoid.leg.link_frames import held_directions, link_frame
from exoid.leg.model import configuration
from exoid.rig.ground import GroundPlant, Sole
from exoid.rig.ground.plant import soles_of

BRAKE = 5.0
"""Damping of the joints while nothing touches the ground [N·m·s/rad], an assumption."""

BASE = 3
"""Coordinates of a planar base: hip forward, hip up, pitch."""


class ContactRows(NamedTuple):
    """Directions that a contact holds, J dnu + drift = 0, and the cone of its force, cone @ f ≤ 0."""

    J: FloatArray  # (c, 3 + n), c = 3 for a flat sole, 2 for a point
    drift: FloatArray  # acceleration at dnu = 0, (c,)
    cone: FloatArray  # friction cone and edges of the sole, (k, c)
    place: FloatArray  # place of a point along and across the ground, of a flat sole along its axes [m], (2,)


@dataclass(frozen=True, eq=False)
class GroundModel(ControlModel):
    """Model of a machine on the ground, as its base class is that of a leg; made by :meth:`on`."""

    # The state of the base is its pitch and its rate alone: position and linear velocity have no effect.
    soles: Mapping[str, Sole] = field(default_factory=dict)  # places that can touch, by the name of their link

    def __post_init__(self) -> None:
        """Check the base, in place of the check of a leg's model."""
        where = self.leg.description.name
        if self.leg.base != "floating":
            raise NotSupportedError(
                "a law on the ground needs a base that floats",
                where=where,
                remedy='identify exoid.load_exo("bleex", base="floating"), or use exoid.control.impedance',
            )
        if not self.leg.limbs:
            raise NotSupportedError(
                "a law on the ground needs a planar machine", where=where, remedy="use legs in parallel planes"
            )

    @classmethod
    def on(cls, source: Estimate | Leg | GroundPlant, soles: Mapping[str, Sole] | None = None) -> GroundModel:
        """Make the model of an estimate, of a machine without friction, or of a plant, which is exact."""
        if isinstance(source, GroundPlant):
            springs = np.array([source.stiffness, source.constant])
            model = cls(source.leg, springs, source.coulomb, source.viscous, source.armature)
            soles = source.soles if soles is None else soles
        elif isinstance(source, Estimate):
            known = completed(source)
            # without M the base does not float, or the machine is not planar, which is refused below
            M, used = (one["M"] if "M" in source.names else None for one in (source, known))
            if M and used and not max(M.std, abs(used.value - M.value)) <= 0.1 * M.value:  # a guess, not a measurement
                raise NotIdentifiableError(
                    f"the estimate does not know the total mass: M = {M.value:.3g} ± {M.std:.3g} kg, and "
                    f"{used.value:.3g} kg with what it does not determine as in the URDF",
                    where=source.leg.description.name,
                    remedy="identify with a log of stance as well, and mend what the findings of the estimate name",
                    parameters=("M",),
                )
            model = replace(cls.of_parameters(source.model, known.values), passive=source.passive)  # type: ignore[assignment]
        else:
            model = cls.of(source)  # type: ignore[assignment]
        soles = soles_of(model.leg, soles)
        refuse_backwards(model.leg, soles)
        return replace(model, soles=soles)

    def gravity(self, q: FloatArray) -> FloatArray:
        """Compute the gravity torque of the joints, feet in the air and torso upright."""
        return self.leg.gravity(q)[0, BASE:]

    @cached_property
    def pinocchio(self) -> pin.Model:
        """Bodies and rotors behind a free base, without gravity, with a frame at the middle of each sole."""
        leg = self.leg
        free = free_flyer_model(leg.model)
        free.armature[6:] += self.armature
        for link, sole in self.soles.items():
            body, placement = link_frame(leg.model, leg.description, link)
            axes = held_directions(leg.model, leg.description, link, leg.plane)[:3, :3]
            place = placement * pin.SE3(axes.T, 0.5 * (sole.points.min(axis=0) + sole.points.max(axis=0)))
            free.addFrame(pin.Frame(f"exoid sole {link}", body + 2, 0, place, pin.FrameType.OP_FRAME))
        free.gravity.setZero()
        return free

    @cached_property
    def places(self) -> dict[str, tuple[int, float]]:
        """Frame at the middle of each sole, x forward and z up at the zero pose, and half its length [m]."""
        return {
            link: (self.pinocchio.getFrameId(f"exoid sole {link}"), 0.5 * float(np.ptp(points[:, 0])))
            for link, points in ((link, from_joint(self.leg, link, sole)) for link, sole in self.soles.items())
        }

    @cached_property
    def turns(self) -> dict[str, FloatArray]:
        """Signs by which the joints turn each sole against the torso, positive like the pitch, (n,)."""
        out = {link: np.zeros(self.n) for link in self.soles}
        for link, signs in out.items():
            for limb in self.leg.limbs:
                place = link_frame(self.leg.model, self.leg.description, link).body - limb.joints.start
                if 0 <= place < limb.chain.n:
                    signs[limb.joints][: place + 1] = limb.chain.signs[: place + 1]
        return out

    @cached_property
    def _base(self) -> FloatArray:
        """Twist of the root link and joints per unit of each coordinate, (6 + n, 3 + n)."""
        out = np.zeros((6 + self.n, BASE + self.n))
        out[:6, :BASE] = planar_coordinates(self.leg.plane, self.leg.hip)
        out[6:, BASE:] = np.eye(self.n)
        return out

    def dynamics(self, q: FloatArray, v: FloatArray, pitch: float, pitch_rate: float) -> tuple[FloatArray, FloatArray]:
        """Compute M and h of M dnu + h = (0, tau) + sum Jᵀ f, and keep the kinematics for :meth:`contact`."""
        # without springs and friction of the joints; the pitch is about −lateral
        model, data, spin = self.pinocchio, self._data, -self.leg.plane.lateral
        joints = np.concatenate([np.zeros(6), q])[None]
        position = configuration(model, joints)[0]
        velocity = np.concatenate([np.zeros(3), pitch_rate * spin, v])
        falling = np.zeros(6 + self.n)
        falling[:3] = -pin.exp3(-pitch * spin) @ self.leg.model.gravity.linear  # specific force in the torso's axes
        M = np.triu(pin.crba(model, data, position))
        M = M + np.triu(M, 1).T
        h = pin.rnea(model, data, position, velocity, falling)
        pin.forwardKinematics(model, data, position, velocity, np.zeros(6 + self.n))
        pin.computeJointJacobians(model, data, position)
        B = self._base
        return B.T @ M @ B, B.T @ h

    def contact(
        self, link: str, kind: str, pose: tuple[FloatArray, FloatArray, float, float], cone: tuple[float, float, float]
    ) -> ContactRows:
        """Form the rows of a contact in the pose of the last :meth:`dynamics`, given friction, margin and lean."""
        (q, v, pitch, pitch_rate), (friction, margin, lean) = pose, cone
        # A flat sole has the ground's axes, its force and its moment about its middle. A heel, a toe or a point has a
        # force along and across ground that leans. The centre of pressure is a margin from the ends of a flat sole.
        frame, half = self.places[link]
        local = pin.ReferenceFrame.LOCAL
        J = pin.getFrameJacobian(self.pinocchio, self._data, frame, local)[[0, 2, 4]] @ self._base
        drift = pin.getFrameClassicalAcceleration(self.pinocchio, self._data, frame, local).vector[[0, 2, 4]]
        J[2], drift[2] = -J[2], -drift[2]  # pitch is positive about −lateral
        at = pin.updateFramePlacement(self.pinocchio, self._data, frame)
        place = (at.rotation.T @ at.translation)[[0, 2]]
        if kind == "flat" and half > 0.0:
            reach = max(half - margin, 0.0)
            edges = [(1.0, -friction, 0.0), (-1.0, -friction, 0.0), (0.0, -reach, 1.0), (0.0, -reach, -1.0)]
            return ContactRows(J, drift, np.array(edges), place)
        arm = {"heel": -half, "toe": half, "flat": 0.0}[kind]
        turning, tilt = pitch_rate + self.turns[link] @ v, pitch + self.turns[link] @ q - lean
        J, drift = np.array([J[0], J[1] + arm * J[2]]), drift[:2] - np.array([arm * turning**2, 0.0])
        turn, end = (
            np.array([[np.cos(tilt), -np.sin(tilt)], [np.sin(tilt), np.cos(tilt)]]),
            place + np.array([arm, 0.0]),
        )
        return ContactRows(turn @ J, turn @ drift, np.array([(1.0, -friction), (-1.0, -friction)]), turn @ end)
