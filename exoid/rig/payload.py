"""Loads strapped to the segments of a leg: sandbags as in document 2, or a weight that no controller was told of."""

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
    """A body strapped to a segment.

    Attributes:
        joint: Name (or label) of the joint that carries it: the hip for the thigh, the knee for the shank.
        mass: [kg].
        position: Of its centre in that joint's frame [m]; at the zero pose of the built-in legs x is forward and z up.
        gyration: Radius of gyration about its centre [m], 0 for a point.

    Raises:
        ExoidError: A number is not finite, or mass or radius negative.
    """

    joint: str
    mass: float
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    gyration: float = 0.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        numbers = (self.mass, self.gyration, *self.position)
        if len(self.position) != 3 or not np.isfinite(numbers).all() or min(self.mass, self.gyration) < 0.0:
            raise ExoidError(f"no such payload: {self}", remedy="give mass in kg ≥ 0, and x, y, z in m")


WINTER = {
    "hip": (0.245, ((0.100, 0.433),), 0.323),
    "knee": (0.246, ((0.0465, 0.433), (0.0145, 1.0)), 0.302),
}
"""Winter's table: length over height; mass over body mass and centre over length of thigh, or of shank and foot, which
is lumped into the shank at its end; radius of gyration of the segment over its length."""


def sandbags(height: float = 1.70, mass: float = 65.0, share: float = 1.0) -> tuple[Payload, ...]:
    """Loads that weigh what thigh and shank of a wearer weigh, by Winter's table, as document 2 straps them on.

    The built-in CUHK-EXO carries such a wearer already.

    Args:
        height: Of the wearer [m].
        mass: Of the wearer [kg].
        share: Of the segments' masses, 1 for all.

    Returns:
        Of thigh, shank and foot, straight below hip and knee.

    Raises:
        ExoidError: Height or mass are not positive.
    """
    if not (0.0 < height < np.inf and 0.0 < mass < np.inf and 0.0 <= share < np.inf):
        raise ExoidError(f"a wearer of {height:g} m and {mass:g} kg", remedy="give positive numbers")
    loads = []
    for joint, (part, parts, gyration) in WINTER.items():
        length = part * height
        for k, (weight, centre) in enumerate(parts):
            radius = gyration * length if k == 0 else 0.0  # the foot counts as a point
            loads.append(Payload(joint, share * weight * mass, (0.0, 0.0, -centre * length), radius))
    return tuple(loads)


def load_plant(plant: Plant, payloads: Sequence[Payload]) -> Plant:
    """Strap payloads to every rig of a plant.

    Raises:
        ExoidError: The leg has no such joint.
    """
    return replace(plant, parameters=plant.parameters + _added(plant.leg, payloads)[:, None])


def load_leg_with(leg: Leg, payloads: Sequence[Payload]) -> Leg:
    """Strap payloads to a leg, so that its model knows of them.

    Raises:
        ExoidError: The leg has no such joint.
    """
    return leg.with_parameters(leg.parameters + _added(leg, payloads))


def _added(leg: Leg, payloads: Sequence[Payload]) -> FloatArray:
    """What payloads add to the parameters, (p,): these are linear in the inertias."""
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
