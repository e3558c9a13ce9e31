"""Control on the ground: a whole-body law for a machine whose base floats."""

from .law import GroundState, GroundTarget, StanceCommand, StanceLaw, share_course, stance
from .loop import GroundLoop
from .model import SOLES, GroundModel

__all__ = [
    "SOLES",
    "GroundLoop",
    "GroundModel",
    "GroundState",
    "GroundTarget",
    "StanceCommand",
    "StanceLaw",
    "share_course",
    "stance",
]
