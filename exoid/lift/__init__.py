"""From base parameters back to links that can exist."""

from .lift import Lift, lift
from .lumping import share_out
from .physical import MassBound, PhysicalCheck, check

__all__ = ["Lift", "MassBound", "PhysicalCheck", "check", "lift", "share_out"]
