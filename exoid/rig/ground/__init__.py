"""Virtual rig with ground: torso and legs that stand or walk, simulated by MuJoCo (extra ``ground``)."""

from .motion import GroundMotion, JointGains, Spring
from .plant import GroundPlant, Sole
from .run import GroundRun
from .sensors import GroundSensors
from .simulate import simulate_on_ground

__all__ = [
    "GroundMotion",
    "GroundPlant",
    "GroundRun",
    "GroundSensors",
    "JointGains",
    "Sole",
    "Spring",
    "simulate_on_ground",
]
