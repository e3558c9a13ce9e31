"""Control on the ground: a whole-body law for a machine whose base floats."""

from .law import GroundState, GroundTarget, StanceCommand, StanceLaw, share_course, stance
from .model import SOLES, GroundModel

__all__ = [
    "SOLES",
    "GroundModel",
    "GroundState",
    "GroundTarget",
    "StanceCommand",
    "StanceLaw",
    "share_course",
    "stance",
]
