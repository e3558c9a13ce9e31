"""Links on the ground: which rest, what their wrenches leave of the equation, and where the base is."""

from .elimination import Elimination, eliminate, reference_axes
from .placements import level_rotation, link_placements
from .standing_base import standing_base
from .stretches import EDGE, SHORTEST, Left, Stretch, stretches, touching
from .support_model import LOOP, SupportModel

__all__ = [
    "EDGE",
    "LOOP",
    "SHORTEST",
    "Elimination",
    "Left",
    "Stretch",
    "SupportModel",
    "eliminate",
    "level_rotation",
    "link_placements",
    "reference_axes",
    "standing_base",
    "stretches",
    "touching",
]
