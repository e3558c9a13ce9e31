"""Observers of the torque that a wearer, or a contact, exerts on a leg."""

from .kalman_observer import KalmanObserver
from .momentum_observer import MomentumObserver
from .noise import SensorNoise
from .observer import TorqueObserver
from .readings import ObservedTorque, ObserverReading

__all__ = [
    "KalmanObserver",
    "MomentumObserver",
    "ObservedTorque",
    "ObserverReading",
    "SensorNoise",
    "TorqueObserver",
]
