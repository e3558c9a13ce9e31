"""Segments of a wearer's leg by height and mass, from Winter's anthropometric table."""

from __future__ import annotations

import numpy as np

from .errors import ExoidError
from .payload import Payload

WINTER = {
    "hip": (0.245, ((0.100, 0.433),), 0.323),
    "knee": (0.246, ((0.0465, 0.433), (0.0145, 1.0)), 0.302),
}
"""Winter's anthropometric table for the thigh (hip) and for shank and foot (knee).

Each entry holds the segment length over height, the parts, and the radius of gyration over segment length. A part is
(mass over body mass, centre of mass over segment length). The foot is a point mass at the end of the shank.
"""


def limb_bodies(height: float, mass: float, share: float = 1.0) -> tuple[Payload, ...]:
    """Make thigh, shank and foot of a wearer, straight below hip and knee.

    Args:
        height: Height of the wearer [m].
        mass: Mass of the wearer [kg].
        share: Fraction of the segment masses, 1 for all.

    Returns:
        The bodies, on the joints "hip" and "knee".

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
