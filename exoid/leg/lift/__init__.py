"""Lift: from base parameters to physically consistent links."""

from .lift import Lift, lift
from .physical import PhysicalCheck, check_physical

__all__ = ["Lift", "PhysicalCheck", "check_physical", "lift"]
