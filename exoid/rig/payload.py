"""Payloads on the virtual rig: sandbags as in document 2, or a weight that the controller does not know."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from exoid.errors import ExoidError
from exoid.leg.leg import Leg
from exoid.leg.payload import Payload
from exoid.torques.payloads import payload_parameters

from .anthropometry import WINTER, refuse_stature
from .plant import Plant


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
    refuse_stature(height, mass)
    if not 0.0 <= share < np.inf:
        raise ExoidError(f"sandbags of {share:g} times the masses of a wearer", remedy="give a fraction ≥ 0")
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
    return replace(plant, parameters=plant.parameters + payload_parameters(plant.leg, payloads)[:, None])


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
    return leg.with_parameters(leg.parameters + payload_parameters(leg, payloads))
