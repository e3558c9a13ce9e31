"""Signals: recordings, log files, checks, filters and derivatives."""

from . import datasets
from .base_motion import BaseMotion
from .base_pose import BasePose, turn_upright
from .column import Column
from .contacts import contacts_from_wrench
from .contacts_from_motion import contacts_from_motion
from .cutoff import choose_preparation
from .differentiation import Kinematics, motion_edge
from .filters.low_pass import zero_phase
from .filters.parallel import ParallelFilter
from .link_wrenches import link_placement, wrenches_on_links
from .opensim import read_opensim
from .opensim_forces import GroundForces, read_opensim_forces
from .poses import Approaches, Poses
from .preparation import FiniteDifference, MovingAverage, Preparation, Smoothed, ZeroPhase
from .readers import ReadOptions
from .recording import Recording
from .recordings import Recordings
from .source import Source
from .torque_delay import without_torque_delay
from .wrench import Wrench, WrenchFrame

__all__ = [
    "Approaches",
    "BaseMotion",
    "BasePose",
    "Column",
    "FiniteDifference",
    "GroundForces",
    "Kinematics",
    "MovingAverage",
    "ParallelFilter",
    "Poses",
    "Preparation",
    "ReadOptions",
    "Recording",
    "Recordings",
    "Smoothed",
    "Source",
    "Wrench",
    "WrenchFrame",
    "ZeroPhase",
    "choose_preparation",
    "contacts_from_motion",
    "contacts_from_wrench",
    "datasets",
    "link_placement",
    "motion_edge",
    "read_opensim",
    "read_opensim_forces",
    "turn_upright",
    "without_torque_delay",
    "wrenches_on_links",
    "zero_phase",
]
