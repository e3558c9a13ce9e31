"""The wearer in recordings: torque between wearer and leg, its test, and its profile over the gait."""

from .action import JointAction
from .gait import GaitProfile
from .interaction import Interaction, interaction

__all__ = ["GaitProfile", "Interaction", "JointAction", "interaction"]
