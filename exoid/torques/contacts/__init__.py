"""Links on the ground: which rest, what their wrenches leave of the equation, and where the base is."""

from .elimination import Elimination, eliminate, reference_axes
from .imu import ImuErrors, imu_errors
from .placements import level_rotation, link_placements
from .standing_base import StandingBase, standing_base
from .stretches import EDGE, SHORTEST, Left, Split, Stretch, contact_of, split
from .support_model import LOOP, SupportModel

__all__ = [
    "EDGE",
    "LOOP",
    "SHORTEST",
    "Elimination",
    "ImuErrors",
    "Left",
    "Split",
    "StandingBase",
    "Stretch",
    "SupportModel",
    "contact_of",
    "eliminate",
    "imu_errors",
    "level_rotation",
    "link_placements",
    "reference_axes",
    "split",
    "standing_base",
]
