"""Virtual rig with ground: torso and legs that stand or walk, simulated by MuJoCo (extra ``ground``)."""

from .control import HEALTHY, PASSIVE, SPASTIC, Faults, GroundController, GroundReading, GroundWearer
from .motion import GroundMotion, JointGains, Spring
from .plant import Block, GroundPlant, Sole
from .run import GroundRun
from .sensors import GroundSensors
from .simulate import simulate_on_ground

__all__ = [
    "HEALTHY",
    "PASSIVE",
    "SPASTIC",
    "Block",
    "Faults",
    "GroundController",
    "GroundMotion",
    "GroundPlant",
    "GroundReading",
    "GroundRun",
    "GroundSensors",
    "GroundWearer",
    "JointGains",
    "Sole",
    "Spring",
    "simulate_on_ground",
]
