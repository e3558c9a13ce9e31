"""Observers of the torque that a wearer, or a contact, exerts on a leg."""

from .kalman_observer import InnovationTest, KalmanObserver
from .momentum_observer import MomentumObserver
from .observer import TorqueObserver
from .readings import ObservedTorque, ObserverReading
from .sensor_noise import SensorNoise

__all__ = [
    "InnovationTest",
    "KalmanObserver",
    "MomentumObserver",
    "ObservedTorque",
    "ObserverReading",
    "SensorNoise",
    "TorqueObserver",
]
