"""Lengths of a wearer in the machine, and flexion of the legs as joint angles."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from exoid._typing import ComplexArray, FloatArray
from exoid.errors import BadArgumentError
from exoid.experiments.ground.posture import PlanarLeg
from exoid.leg.leg import Leg
from exoid.leg.link_frames import held_directions, link_frame
from exoid.rig.ground import Sole
from exoid.signals.link_wrenches import link_placements
from exoid.tools.numbers import ROUNDED, checked

SIDES = ("left", "right")
"""Sides in the order of all tables."""

SEAT = "seat"
"""Name of the contact of the torso with a chair."""

TURNS = np.array([1.0, -1.0, 1.0])
"""Signs of hip, knee and ankle about −lateral: the knee flexes backward."""


@dataclass(frozen=True)
class Body:
    """Lengths of a wearer in the machine, from which trajectories are scaled.

    Attributes:
        thigh: Hip to knee [m].
        shank: Knee to ankle [m]; to the ground for a leg without ankle.
        ankle: Height of the ankle above the sole [m]; 0 for a leg without ankle.
        heel: Heel forward of the ankle, negative [m].
        toe: Toe forward of the ankle [m].
        seat: Height of the hip above the seat while seated [m], an assumption.

    Raises:
        ExoidError: A length is not positive, or the toe is not ahead of the heel.
    """

    thigh: float
    shank: float
    ankle: float = 0.0
    heel: float = -0.01
    toe: float = 0.01
    seat: float = 0.09

    def __post_init__(self) -> None:
        """Check the lengths."""
        checked([self.thigh, self.shank], "the lengths of a leg [m]", above=0.0, most=1.0)
        checked([self.ankle, self.seat, self.toe - self.heel], "the lengths of foot and seat [m]", least=0.0, most=0.5)

    @classmethod
    def of(cls, leg: Leg, soles: Mapping[str, Sole]) -> Body:
        """Read the lengths of the first limb of a planar machine.

        Args:
            leg: Planar machine with hip, knee and perhaps ankle.
            soles: Sole of each foot by the name of its link.

        Returns:
            The lengths.

        Raises:
            ExoidError: The machine is not planar, its legs have other joints, or it faces backwards.
        """
        joints = [limb.chain.n for limb in leg.limbs]
        foot = next((link for link in soles if link != leg.description.root_link), None)
        if not joints or joints[0] not in (2, 3) or foot is None:
            raise BadArgumentError(
                "no lengths of hip, knee and sole", where=leg.description.name, remedy="use a planar machine with soles"
            )
        refuse_backwards(leg, soles)
        offsets = np.linalg.norm(leg.limbs[0].chain.offsets, axis=1)
        forward, _, up = from_joint(leg, foot, soles[foot]).T
        # without an ankle the sole is on the shank
        shank, ankle, middle = (-up.mean(), 0.0, forward.mean()) if joints[0] == 2 else (offsets[1], -up.mean(), 0.0)
        return cls(*map(float, (offsets[0], shank, ankle, forward.min() - middle, forward.max() - middle)))

    @property
    def leg(self) -> float:
        """Length of the straight leg, sole to hip [m]."""
        return self.thigh + self.shank + self.ankle

    def reach(
        self, hip: ComplexArray, pitch: FloatArray | float, middle: ComplexArray, tilt: FloatArray | float
    ) -> FloatArray:
        """Find the flexion that puts the middle of a sole at a place (two links and a foot).

        Args:
            hip: Place of the hip [m], (K,).
            pitch: Pitch of the torso [rad]; negative leans forward, (K,) or a number.
            middle: Place of the middle of the sole [m], (K,).
            tilt: Angle of the sole to the horizontal, toe up [rad], (K,) or a number.

        Returns:
            Flexion of hip, knee and ankle [rad], (K, 3).

        Raises:
            ExoidError: The leg is too short.
        """
        base = np.column_stack(np.broadcast_arrays(hip.real, hip.imag, pitch))
        return self._straight.angles(base, middle, np.asarray(tilt))

    def sole(self, hip: ComplexArray, pitch: FloatArray | float, flexion: FloatArray) -> ComplexArray:
        """Locate heel and toe of a leg.

        Args:
            hip: Place of the hip [m], (K,).
            pitch: Pitch of the torso [rad], (K,) or a number.
            flexion: Flexion of hip, knee and ankle [rad], (K, 3).

        Returns:
            Places of heel and toe [m], (K, 2).
        """
        return self._straight.points(np.column_stack(np.broadcast_arrays(hip.real, hip.imag, pitch)), flexion)

    @property
    def _straight(self) -> PlanarLeg:
        """Leg that is straight at zero, with the sole level and the hip at the origin of the torso."""
        sole = np.array([self.heel, self.toe]) - 1j * self.ankle
        return PlanarLeg("a foot", slice(0, 3), 0.0, -1j * self.thigh, -1j * self.shank, sole, TURNS, 1.0)


def joint_angles(leg: Leg, flexion: FloatArray) -> FloatArray:
    """Convert flexion of both legs to the joint angles of a machine, for any direction of its axes.

    Args:
        leg: Planar machine of two legs with hip, knee and perhaps ankle; names of joints begin with the side.
        flexion: Flexion of the left and of the right leg [rad], (K, 2, 3).

    Returns:
        Angles [rad], (K, n).

    Raises:
        ExoidError: The machine has not two such legs.
    """
    if {limb.label for limb in leg.limbs} != {*SIDES} or any(limb.chain.n not in (2, 3) for limb in leg.limbs):
        remedy = 'use two planar legs, whose joints have names that begin with "left" and "right"'
        raise BadArgumentError("no functions for these legs", where=leg.description.name, remedy=remedy)
    own = [(limb.chain, flexion[:, SIDES.index(limb.label)]) for limb in leg.limbs]
    return np.hstack([angles[:, : chain.n] * (TURNS[: chain.n] * chain.signs) for chain, angles in own])


def legs_flexion(leg: Leg, q: FloatArray) -> FloatArray:
    """Convert joint angles to flexion of both legs, the inverse of :func:`joint_angles`.

    Args:
        leg: Planar machine as there.
        q: Angles [rad], (K, n).

    Returns:
        Flexion of the left and of the right leg [rad], (K, 2, 3); zero of a missing ankle.
    """
    out = np.zeros((len(q), 2, 3))
    for limb in leg.limbs:
        n = limb.chain.n
        out[:, SIDES.index(limb.label), :n] = q[:, limb.joints] * (TURNS[:n] * limb.chain.signs)
    return out


def contact_name(leg: Leg, link: str) -> str:
    """Name the contact of a link.

    Args:
        leg: Machine of two legs, as there.
        link: The link.

    Returns:
        "left", "right", or "seat" of the root link.
    """
    body, _ = link_frame(leg.model, leg.description, link)
    return next((limb.label for limb in leg.limbs if limb.joints.start <= body < limb.joints.stop), SEAT)


def refuse_backwards(leg: Leg, soles: Mapping[str, Sole]) -> None:
    """Refuse a machine whose right leg is on the left of its plane, or whose soles point backwards."""
    # The plane of a leg points to x or −y: its sign is that of its axis, and says nothing about the machine.
    sides, behind, still = {"left": np.inf, "right": -np.inf}, False, np.zeros((1, len(leg.joint_names)))
    for link, sole in soles.items():
        if (side := contact_name(leg, link)) != SEAT:
            sides[side] = float(link_placements(leg, still, link).translation[0] @ leg.plane.lateral)
            ahead = from_joint(leg, link, sole)[:, 0]
            # the middle is ahead of the ankle by 0.13 of the length of BLEEX's sole, by −0.13 if it is reversed
            behind |= bool(0.5 * (ahead.min() + ahead.max()) < -0.1 * np.ptp(ahead))
    if behind or sides["left"] < sides["right"] - ROUNDED:
        raise BadArgumentError(
            f"{'the soles point backwards' if behind else 'the left foot is on the right'}: forward is "
            f"{(leg.plane.forward.round(3) + 0.0).tolist()} in the axes of {leg.description.root_link}",
            where=leg.description.name,
            remedy="write the URDF with x forward and y left (docs/floating-base.md), or correct sides and soles",
        )


def from_joint(leg: Leg, link: str, sole: Sole) -> FloatArray:
    """Points of a sole from the joint that carries it, forward, sideward and up at the zero pose [m], (K, 3)."""
    axes = held_directions(leg.model, leg.description, link, leg.plane)[:3, :3]
    placement = link_frame(leg.model, leg.description, link).placement
    return np.asarray((sole.points - placement.inverse().translation) @ axes.T)
