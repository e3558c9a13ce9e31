"""Limb of a wearer by anthropometry: Winter's table of thigh, shank and foot (Winter 2009)."""

from __future__ import annotations

import numpy as np

from exoid.errors import ExoidError
from exoid.leg.leg import Leg
from exoid.leg.payload import Payload
from exoid.torques.payloads import payload_parameters

WINTER = {
    "hip": (0.245, ((0.100, 0.433),), 0.323),
    "knee": (0.246, ((0.0465, 0.433), (0.0145, 1.0)), 0.302),
}
"""Winter's anthropometric table for the thigh (hip) and for shank and foot (knee).

Each entry holds the segment length over height, the parts, and the radius of gyration over segment length. A part is
(mass over body mass, centre of mass over segment length). The foot is a point mass at the end of the shank.
"""


def limb_of(leg: Leg, height: float = 1.75, mass: float = 70.0) -> Leg:
    """Make the limb of a wearer: the joints of the leg with thigh, shank and foot of a person.

    The joints of the limb coincide with those of the leg. At the zero pose the person stands upright. Without an ankle
    the foot is a point mass at the end of the shank, as for :func:`exoid.rig.sandbags`.

    Args:
        leg: Planar leg with joints hip, knee and ankle, or some of them.
        height: Height of the wearer [m].
        mass: Mass of the wearer [kg].

    Returns:
        The limb.

    Raises:
        ExoidError: The leg has other joints, or height or mass are not those of a person.

    Example:
        >>> import exoid
        >>> limb_of(exoid.load_leg("cuhk"), 1.70, 65.0).parameters.round(3)
        array([2.824, 0.   , 1.017, 0.941, 0.   , 0.312])
    """
    refuse_stature(height, mass)
    if not (height < 2.6 and mass < 350.0):  # other units
        raise ExoidError(f"a wearer of {height:g} m and {mass:g} kg", remedy="give the height in m and the mass in kg")
    chain, labels = leg.chain, leg.joint_labels
    if chain is None or any(label not in (*WINTER, "ankle") for label in labels):
        raise ExoidError(
            f"no anthropometry for the joints {', '.join(labels)}",
            where=leg.description.name,
            remedy="make the limb of a leg with hip, knee and ankle, or give Wearer(limb=leg.with_parameters(...))",
        )
    bodies = []
    for joint, turn in zip(labels, chain.rotations, strict=True):
        for weight, ahead, below, gyration in _bodies(joint, "ankle" in labels):
            centre = height * (ahead * chain.plane.forward - below * chain.plane.up)
            bodies.append(Payload(joint, weight * mass, tuple((turn.T @ centre).tolist()), gyration * height))
    return leg.with_parameters(payload_parameters(leg, bodies))


def refuse_stature(height: float, mass: float) -> None:
    """Refuse a height or mass that is not positive."""
    if not (0.0 < height < np.inf and 0.0 < mass < np.inf):
        raise ExoidError(f"a wearer of {height:g} m and {mass:g} kg", remedy="give positive numbers")


def _bodies(joint: str, with_ankle: bool) -> list[tuple[float, float, float, float]]:
    """Bodies of a segment: mass over body mass; distances ahead and below, and radius of gyration, over height."""
    if joint == "ankle":
        # distance from the ankle to the second metatarsal head over height: an assumption for Winter's foot of 0.152;
        # the centre of mass is assumed at half of the height of the ankle, 0.039
        length = 0.11
        return [(0.0145, 0.50 * length, 0.5 * 0.039, 0.475 * length)]
    length, parts, gyration = WINTER[joint]
    segment, *foot = [(weight, 0.0, centre * length, 0.0) for weight, centre in parts]
    return [(*segment[:3], gyration * length), *([] if with_ankle else foot)]
