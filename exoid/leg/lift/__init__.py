"""Lift: from base parameters to physically consistent links."""

from .lift import Lift, lift
from .physical import PhysicalCheck, check

__all__ = ["Lift", "PhysicalCheck", "check", "lift"]
