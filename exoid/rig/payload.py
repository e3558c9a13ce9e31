"""Payloads on the segments of a leg: sandbags as in document 2, or a weight that the controller does not know."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.leg import Leg
from exoid.model import dynamic_parameters, with_dynamic_parameters

from .plant import Plant


@dataclass(frozen=True)
class Payload:
    """Body fixed to a segment.

    Attributes:
        joint: Name or label of the joint that carries the body: the hip for the thigh, the knee for the shank.
        mass: Mass [kg].
        position: Centre of mass in the frame of that joint [m]. At the zero pose of the built-in legs x points forward
            and z up.
        gyration: Radius of gyration about the centre of mass [m], 0 for a point mass.

    Raises:
        ExoidError: A number is not finite, or mass or radius is negative.
    """

    joint: str
    mass: float
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    gyration: float = 0.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        numbers = (self.mass, self.gyration, *self.position)
        if len(self.position) != 3 or not np.isfinite(numbers).all() or min(self.mass, self.gyration) < 0.0:
            raise ExoidError(f"invalid payload: {self}", remedy="give mass in kg ≥ 0, and x, y, z in m")


WINTER = {
    "hip": (0.245, ((0.100, 0.433),), 0.323),
    "knee": (0.246, ((0.0465, 0.433), (0.0145, 1.0)), 0.302),
}
"""Winter's anthropometric table for the thigh (hip) and for shank and foot (knee).

Each entry holds the segment length over height, the parts, and the radius of gyration over segment length. A part is
(mass over body mass, centre of mass over segment length). The foot is a point mass at the end of the shank.
"""


def sandbags(height: float = 1.70, mass: float = 65.0, share: float = 1.0) -> tuple[Payload, ...]:
    """Make payloads that weigh as much as thigh, shank and foot of a wearer by Winter's table, as in document 2.

    The built-in CUHK-EXO already carries such a wearer.

    Args:
        height: Height of the wearer [m].
        mass: Mass of the wearer [kg].
        share: Fraction of the segment masses, 1 for all.

    Returns:
        Payloads of thigh, shank and foot, straight below hip and knee.

    Raises:
        ExoidError: Height or mass is not positive, or the fraction is negative.
    """
    if not (0.0 < height < np.inf and 0.0 < mass < np.inf and 0.0 <= share < np.inf):
        raise ExoidError(f"a wearer of {height:g} m and {mass:g} kg", remedy="give positive numbers")
    loads = []
    for joint, (part, parts, gyration) in WINTER.items():
        length = part * height
        for k, (weight, centre) in enumerate(parts):
            radius = gyration * length if k == 0 else 0.0  # the foot is a point mass
            loads.append(Payload(joint, share * weight * mass, (0.0, 0.0, -centre * length), radius))
    return tuple(loads)


def plant_with_payloads(plant: Plant, payloads: Sequence[Payload]) -> Plant:
    """Fix payloads to every rig of a plant.

    Args:
        plant: B rigs.
        payloads: Bodies to add.

    Returns:
        The plant with the payloads.

    Raises:
        ExoidError: The leg does not have a joint that a payload names.
    """
    return replace(plant, parameters=plant.parameters + _added(plant.leg, payloads)[:, None])


def leg_with_payloads(leg: Leg, payloads: Sequence[Payload]) -> Leg:
    """Fix payloads to a leg, so that its model includes them.

    Args:
        leg: The leg.
        payloads: Bodies to add.

    Returns:
        The leg with the payloads.

    Raises:
        ExoidError: The leg does not have a joint that a payload names.
    """
    return leg.with_parameters(leg.parameters + _added(leg, payloads))


def _added(leg: Leg, payloads: Sequence[Payload]) -> FloatArray:
    """Contribution of payloads to the parameters, which are linear in the inertias, (p,)."""
    loaded = with_dynamic_parameters(leg.model, dynamic_parameters(leg.model))
    for payload in payloads:
        names = {**dict(zip(leg.joint_labels, leg.joint_names, strict=True)), **{n: n for n in leg.joint_names}}
        if payload.joint not in names:
            raise ExoidError(
                f"a payload on {payload.joint!r}, which the leg does not have",
                where=leg.description.name,
                remedy=f"its joints are {', '.join(leg.joint_names)}",
            )
        inertia = payload.mass * payload.gyration**2 * np.eye(3)
        body = pin.Inertia(payload.mass, np.array(payload.position), inertia)
        loaded.appendBodyToJoint(loaded.getJointId(names[payload.joint]), body, pin.SE3.Identity())
    difference = dynamic_parameters(loaded) - dynamic_parameters(leg.model)
    return leg.reduction.parameters(difference)
