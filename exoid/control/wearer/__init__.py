"""The wearer in recordings: torque between wearer and leg, its test, gait profile, and the limb within the leg."""

from .action import JointAction
from .cuffs import Cuffs
from .gait import GaitProfile
from .interaction import Interaction, interaction
from .limb import LimbComparison, compare_limb, limb_parameters
from .limb_in_cuffs import identify_limb, limb_recording

__all__ = [
    "Cuffs",
    "GaitProfile",
    "Interaction",
    "JointAction",
    "LimbComparison",
    "compare_limb",
    "identify_limb",
    "interaction",
    "limb_parameters",
    "limb_recording",
]
