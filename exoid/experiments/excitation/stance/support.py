"""Support: which feet stand flat while a planar machine moves, and how its joints then move its torso."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.experiments.excitation.limits import MotionLimits
from exoid.experiments.ground.posture import PlanarLeg, planar_legs
from exoid.experiments.references import States
from exoid.leg.base_kinematics import BaseKinematics
from exoid.leg.leg import Leg
from exoid.leg.torso import TorsoMotion, base_kinematics
from exoid.rig.ground import GroundPlant, Sole

BOTH = "both"
"""Name of the support by all feet."""


class TorsoStates(NamedTuple):
    """Motion of the torso over a foot that stands."""

    # position forward and up [m] and pitch [rad] of the root link's origin, (N, 3); the middle of the sole is
    # the origin of the laboratory
    pose: FloatArray
    kinematics: BaseKinematics  # what the equation of motion depends on


class GroundRows(NamedTuple):
    """Rows of the equation of motion while the machine hangs on one foot that stands."""

    # rows of force forward [N] and up [N] and moment about the ankle [N·m] on that foot, (p, 3, N), for the
    # parameters of rigid bodies
    wrench: FloatArray
    torque: FloatArray  # rows of the joint torques if this foot bears everything, (P, n, N)


@dataclass(frozen=True, eq=False)
class StanceSupport:
    """Feet that stand flat, side by side; other legs swing."""

    # A motion has the joints of the first standing leg and of the legs that swing as coordinates. The other
    # standing legs have the same posture.

    name: str  # "both", or the label of the leg that stands
    plant: GroundPlant  # machine with its soles
    stands: tuple[PlanarLeg, ...]  # legs whose feet stand
    swings: tuple[PlanarLeg, ...]  # legs in the air
    hip: complex  # point that the base rows are about, in the axes of the root link [m]

    @classmethod
    def of(cls, plant: GroundPlant, name: str) -> StanceSupport:
        """Find the legs of a support."""
        legs, labels = planar_legs(plant), [limb.label for limb in plant.leg.limbs]
        names = [label or leg.foot for leg, label in zip(legs, labels, strict=True)]
        if name == BOTH:
            stands = legs
        else:
            stands = tuple(leg for leg, label in zip(legs, labels, strict=True) if name in (label, leg.foot))
        if not stands or not name:
            known = ", ".join((BOTH, *names))
            raise BadArgumentError(
                f"no support {name!r}", where=plant.leg.description.name, remedy=f"choose among {known}"
            )
        if not all(_congruent(stands[0], other) for other in stands[1:]):
            raise NotSupportedError(
                "standing on feet side by side is planned for legs of equal size",
                where=plant.leg.description.name,
                remedy=f"plan on each foot alone, {','.join(names)}: this determines all that both would",
            )
        return cls(name, plant, stands, tuple(leg for leg in legs if leg not in stands), legs[0].hip)

    @property
    def leg(self) -> Leg:
        """The machine."""
        return self.plant.leg

    @property
    def feet(self) -> tuple[str, ...]:
        """Links of the feet that stand."""
        return tuple(leg.foot for leg in self.stands)

    @property
    def sole(self) -> Sole:
        """Sole of the first foot that stands."""
        return self.plant.soles[self.feet[0]]

    @property
    def count(self) -> int:
        """Number of coordinates k."""
        return len(self.spread)

    @cached_property
    def spread(self) -> FloatArray:
        """Joint angles per unit of each coordinate, (k, n): q = y @ spread."""
        first, n = self.stands[0], len(self.leg.joint_names)
        own = [first, *self.swings]
        joints = np.concatenate([np.arange(leg.joints.start, leg.joints.stop) for leg in own])
        spread = np.zeros((len(joints), n))
        spread[np.arange(len(joints)), joints] = 1.0
        for other in self.stands[1:]:
            for k, joint in enumerate(range(other.joints.start, other.joints.stop)):
                spread[k, joint] = first.signs[k] * other.signs[k]
        return spread

    @cached_property
    def directions(self) -> FloatArray:
        """Rows of :attr:`spread` of length 1: parts of the torque on which forces on the feet do no work, (k, n)."""
        return np.asarray(self.spread / np.linalg.norm(self.spread, axis=1, keepdims=True))

    def joints(self, states: States) -> States:
        """Compute the motion of all joints."""
        return States(*(part @ self.spread for part in states))

    def coordinate_limits(self, limits: MotionLimits, knee: float) -> MotionLimits:
        """Take limits of joints for the coordinates, with bent knees."""
        lower, upper = limits.lower.copy(), limits.upper.copy()
        for leg in (*self.stands, *self.swings):
            joint = leg.joints.start + 1
            if leg.knee > 0.0:
                lower[joint] = max(lower[joint], knee)
            else:
                upper[joint] = min(upper[joint], -knee)
        moves, flipped = self.spread.T != 0.0, self.spread.T < 0.0
        low = np.where(moves, np.where(flipped, -upper[:, None], lower[:, None]), -np.inf).max(axis=0)
        high = np.where(moves, np.where(flipped, -lower[:, None], upper[:, None]), np.inf).min(axis=0)
        others = (limits.velocity, limits.acceleration, limits.torque)
        least = (np.where(moves, each[:, None], np.inf).min(axis=0) for each in others)
        return MotionLimits(low, high, *least)

    def torso(self, states: States) -> TorsoStates:
        """Compute the motion of the torso over the first foot that stands."""
        # The foot is level and still. With the vectors r_j of shank, thigh and hip at the zero pose and
        # their angles φ_j, the origin of the root link is at p = p_ankle − Σ_j e^{iφ_j} r_j, so p̈ = −Σ_j
        # e^{iφ_j}(i φ̈_j − φ̇_j²) r_j.
        leg = self.stands[0]
        angle, rate, change = (self._turns(part) for part in states)
        vectors = np.exp(1j * angle) * np.array([leg.shank, leg.thigh, leg.hip])
        place = -leg.sole.mean() - vectors.sum(axis=1)
        acceleration = -(vectors * (1j * change - rate**2)).sum(axis=1)
        along = np.column_stack([acceleration.real, acceleration.imag])
        motion = TorsoMotion(angle[:, 2], rate[:, 2], change[:, 2], along)  # about the origin of the root link
        kinematics = base_kinematics(motion, len(angle), self.plant.plane, np.zeros(3))
        return TorsoStates(np.column_stack([place.real, place.imag, angle[:, 2]]), kinematics)

    def ground_rows(self, states: States, rows: FloatArray) -> GroundRows:
        """Find what the first foot that stands bears, and what is left for the joints."""
        # A force f and a moment m about a point r have the moment m + Im{conj(r − p) f} about p. The base
        # rows are about the hip in axes that turn with the torso. They give the wrench on the foot, whose
        # moments about the joints of the leg are taken off the rows of these. This is
        # `exoid.torques.contacts.eliminate` for a planar machine.
        leg, angle, count = self.stands[0], self._turns(states.q), len(self.leg.parameter_names)
        turn = np.exp(1j * angle)
        knee = -turn[:, 0] * leg.shank  # from the ankle
        hip = knee - turn[:, 1] * leg.thigh
        reference = hip + turn[:, 2] * (self.hip - leg.hip)
        rigid = rows[:count]
        force = turn[:, 2] * (rigid[:, 0] + 1j * rigid[:, 1])
        moment = rigid[:, 2] + (reference.conj() * force).imag
        torque = rows[:, 3:].copy()
        for k, place in enumerate((hip, knee, 0.0)):
            torque[:count, leg.joints.start + k] -= leg.signs[k] * (moment - (np.conj(place) * force).imag)
        return GroundRows(np.stack([force.real, force.imag, moment], axis=1), torque)

    def _turns(self, joints: FloatArray) -> FloatArray:
        """Angles of shank, thigh and torso over a level foot, (N, 3); or rates, or accelerations."""
        leg = self.stands[0]
        return np.asarray(-np.cumsum((leg.signs * joints[:, leg.joints])[:, ::-1], axis=1))

    def heights(self, q: FloatArray, pose: FloatArray) -> FloatArray:
        """Compute the heights of the soles in the air."""
        parts = [leg.points(pose, q).imag for leg in self.swings]
        return np.hstack(parts) if parts else np.empty((len(pose), 0))


def supports_of(leg: Leg, names: Sequence[str], soles: Mapping[str, Sole]) -> tuple[StanceSupport, ...]:
    """Find several supports of a machine."""
    if not names or len(set(names)) < len(names):
        raise BadArgumentError(f"supports {', '.join(names) or 'none'}", remedy='name each once, e.g. ("both", "left")')
    plant = GroundPlant.build(leg, soles)
    if not plant.is_planar:
        raise NotSupportedError(
            "stance is planned for planar machines",
            where=leg.description.name,
            remedy="use legs whose joint axes are parallel",
        )
    return tuple(StanceSupport.of(plant, name) for name in names)


def _congruent(one: PlanarLeg, other: PlanarLeg) -> bool:
    sizes = [np.array([leg.hip, leg.thigh, leg.shank, *leg.sole]) for leg in (one, other)]
    return sizes[0].shape == sizes[1].shape and bool(np.abs(sizes[0] - sizes[1]).max() < 1e-6)  # [m]
