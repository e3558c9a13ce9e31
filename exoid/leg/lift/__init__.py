"""Lift: from base parameters to physically consistent links."""

from .lift import PULL, Lift, consistent_within, lift
from .lumping import distribute_bodies
from .masses import MASS_FACTOR, MassChange
from .physical import MassBound, PhysicalCheck, check

__all__ = [
    "MASS_FACTOR",
    "PULL",
    "Lift",
    "MassBound",
    "MassChange",
    "PhysicalCheck",
    "check",
    "consistent_within",
    "distribute_bodies",
    "lift",
]
