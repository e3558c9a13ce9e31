"""Observer of the torque that a wearer, or a contact, exerts on a leg."""

from .momentum_observer import MomentumObserver
from .noise import SensorNoise
from .readings import ObservedTorque, ObserverReading

__all__ = [
    "MomentumObserver",
    "ObservedTorque",
    "ObserverReading",
    "SensorNoise",
]
