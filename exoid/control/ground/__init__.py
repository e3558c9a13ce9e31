"""Control on the ground: a whole-body law for a machine whose base floats, which contacts hold, and functions."""

from exoid.rig.ground.plant import SOLES

from .coordinator import SAFE, TABLE, Coordinator, Decision, Rule
from .hypotheses import Belief, ContactFilter, ContactNoise, ContactReadings
from .law import GroundState, GroundTarget, StanceCommand, StanceLaw, stance
from .loop import CoordinatedLoop, GroundLoop

__all__ = [
    "SAFE",
    "SOLES",
    "TABLE",
    "Belief",
    "ContactFilter",
    "ContactNoise",
    "ContactReadings",
    "CoordinatedLoop",
    "Coordinator",
    "Decision",
    "GroundLoop",
    "GroundState",
    "GroundTarget",
    "Rule",
    "StanceCommand",
    "StanceLaw",
    "stance",
]
