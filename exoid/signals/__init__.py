"""Signals: logs become arrays that can be trusted, and arrays become kinematics."""

from .differentiation import Kinematics, central_difference, second_difference
from .filters import edge_length, exponential_moving_average, noise_bandwidth, zero_phase
from .preparation import PREPARATIONS, FiniteDifference, MovingAverage, Preparation, ZeroPhase
from .recording import Recording
from .source import Source

__all__ = [
    "PREPARATIONS",
    "FiniteDifference",
    "Kinematics",
    "MovingAverage",
    "Preparation",
    "Recording",
    "Source",
    "ZeroPhase",
    "central_difference",
    "edge_length",
    "exponential_moving_average",
    "noise_bandwidth",
    "second_difference",
    "zero_phase",
]
