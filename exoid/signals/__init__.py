"""Signals: recordings, log files, checks, filters and derivatives."""

from .base_motion import BASE_COLUMNS, BaseMotion
from .cluster import Cluster
from .column import Column
from .default_preparation import ZeroPhase, choose_cutoff
from .differentiation import Kinematics, central_difference, motion_edge, second_difference, smooth_motion
from .filters import ParallelFilter, edge_length, exponential_moving_average, noise_bandwidth, zero_phase
from .formats import register_format
from .moving_base import base_during
from .poses import Approaches, Poses
from .preparation import FiniteDifference, MovingAverage, Preparation, Smoothed
from .preparation_names import PREPARATIONS, preparation_by_name, register_preparation
from .recording import Recording
from .recordings import Recordings
from .source import Source
from .torque_delay import without_torque_delay

__all__ = [
    "BASE_COLUMNS",
    "PREPARATIONS",
    "Approaches",
    "BaseMotion",
    "Cluster",
    "Column",
    "FiniteDifference",
    "Kinematics",
    "MovingAverage",
    "ParallelFilter",
    "Poses",
    "Preparation",
    "Recording",
    "Recordings",
    "Smoothed",
    "Source",
    "ZeroPhase",
    "base_during",
    "central_difference",
    "choose_cutoff",
    "edge_length",
    "exponential_moving_average",
    "motion_edge",
    "noise_bandwidth",
    "preparation_by_name",
    "register_format",
    "register_preparation",
    "second_difference",
    "smooth_motion",
    "without_torque_delay",
    "zero_phase",
]
