"""Lift: from base parameters to physically consistent links."""

from .lift import Lift, lift
from .lumping import distribute_bodies
from .physical import MassBound, PhysicalCheck, check

__all__ = ["Lift", "MassBound", "PhysicalCheck", "check", "distribute_bodies", "lift"]
