"""Observers of the torque that a wearer, or a contact, exerts on a leg."""

from .alignment import Alignment, Channels
from .false_alarms import crossings_per_minute, threshold
from .kalman_observer import InnovationTest, KalmanObserver
from .momentum_observer import MomentumObserver
from .momentum_terms import Momentum, MomentumTerms
from .observer import ObserverMemory, TorqueObserver
from .reading import ObservedTorque, ObserverReading
from .sensor_noise import SensorNoise

__all__ = [
    "Alignment",
    "Channels",
    "InnovationTest",
    "KalmanObserver",
    "Momentum",
    "MomentumObserver",
    "MomentumTerms",
    "ObservedTorque",
    "ObserverMemory",
    "ObserverReading",
    "SensorNoise",
    "TorqueObserver",
    "crossings_per_minute",
    "threshold",
]
