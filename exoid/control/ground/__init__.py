"""Control on the ground: a whole-body law for a machine whose base floats, which contacts hold, and functions."""

from .coordinator import SAFE, TABLE, Coordinator, Decision, Rule
from .hypotheses import Belief, ContactFilter, ContactNoise, ContactReadings
from .law import GroundState, GroundTarget, StanceCommand, StanceLaw, share_course, stance
from .loop import GroundLoop
from .model import SOLES

__all__ = [
    "SAFE",
    "SOLES",
    "TABLE",
    "Belief",
    "ContactFilter",
    "ContactNoise",
    "ContactReadings",
    "Coordinator",
    "Decision",
    "GroundLoop",
    "GroundState",
    "GroundTarget",
    "Rule",
    "StanceCommand",
    "StanceLaw",
    "share_course",
    "stance",
]
