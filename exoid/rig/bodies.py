"""Bodies on a leg: payloads, and the limb of a wearer by Winter's table of thigh, shank and foot (Winter 2009)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from exoid.errors import BadArgumentError, NotSupportedError
from exoid.leg.leg import Leg
from exoid.leg.leg_data import joint_roles
from exoid.leg.payload import Payload
from exoid.torques.payloads import payload_parameters

from .plant import Plant

WINTER = {
    "hip": (0.100, 0.0, 0.433 * 0.245, 0.323 * 0.245),
    "knee": (0.0465, 0.0, 0.433 * 0.246, 0.302 * 0.246),
    # Distance from the ankle to the second metatarsal head over height, 0.11: an assumption for Winter's foot of 0.152.
    # The centre of mass is assumed at half of the height of the ankle, 0.039.
    "ankle": (0.0145, 0.50 * 0.11, 0.5 * 0.039, 0.475 * 0.11),
}
"""Thigh (hip), shank (knee) and foot (ankle) by Winter's anthropometric table.

Each is mass over body mass; and over height distances ahead of and below the joint, and the radius of gyration.
"""

FOOT = (0.0145, 0.0, 0.246, 0.0)
"""Foot of a leg without ankle, likewise: a point mass at the end of the shank."""


def limb_of(leg: Leg, height: float = 1.75, mass: float = 70.0, roles: Mapping[str, str] | None = None) -> Leg:
    """Make the limb of a wearer: the joints of the leg with thigh, shank and foot of a person.

    The joints of the limb coincide with those of the leg. At the zero pose the person stands upright. Without an ankle
    the foot is a point mass at the end of the shank.

    Args:
        leg: Planar leg with joints hip, knee and ankle, or some of them.
        height: Height of the wearer [m].
        mass: Mass of the wearer [kg].
        roles: "hip", "knee" or "ankle" for each joint that has another name.

    Returns:
        The limb.

    Raises:
        ExoidError: The leg has other joints, a role does not fit, or height or mass are not those of a person.

    Example:
        >>> import exoid
        >>> limb_of(exoid.load_leg("cuhk"), 1.70, 65.0).parameters.round(3)
        array([2.824, 0.   , 1.017, 0.941, 0.   , 0.312])
    """
    if not (0.0 < height < 2.6 and 0.0 < mass < 350.0):
        raise BadArgumentError(
            f"a wearer of {height:g} m and {mass:g} kg", remedy="give the height in m and the mass in kg"
        )
    chain, labels = leg.chain, joint_roles(leg, roles or {})
    if chain is None or any(label not in WINTER for label in labels):
        raise NotSupportedError(
            f"no anthropometry for the joints {', '.join(labels)}",
            where=leg.description.name,
            remedy="name the role of each joint (roles=...), or give Wearer(limb=leg.with_parameters(...))",
            command=f"name the role of each joint (--role {labels[0]}=hip)",
        )
    bodies = []
    for joint, role, turn in zip(leg.joint_names, labels, chain.rotations, strict=True):
        alone = role == "knee" and "ankle" not in labels
        for weight, ahead, below, gyration in (WINTER[role], FOOT) if alone else (WINTER[role],):
            centre = height * (ahead * chain.plane.forward - below * chain.plane.up)
            bodies.append(Payload(joint, weight * mass, tuple((turn.T @ centre).tolist()), gyration * height))
    return leg.with_parameters(payload_parameters(leg, bodies))


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
    return replace(plant, parameters=plant.parameters + payload_parameters(plant.leg, payloads)[:, None])
