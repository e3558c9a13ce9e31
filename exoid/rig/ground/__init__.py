"""Virtual rig with ground: torso and legs that stand or walk, simulated by MuJoCo (extra ``ground``)."""

from .motion import GroundMotion, JointGains, Spring
from .plant import GroundPlant
from .run import Audit, Footing, GroundRun
from .sensors import GroundSensors
from .simulate import simulate_on_ground
from .sole import Sole

__all__ = [
    "Audit",
    "Footing",
    "GroundMotion",
    "GroundPlant",
    "GroundRun",
    "GroundSensors",
    "JointGains",
    "Sole",
    "Spring",
    "simulate_on_ground",
]
