"""Signals: recordings, log files, checks, filters and derivatives."""

from . import datasets
from .base_motion import BASE_COLUMNS, BaseMotion
from .base_pose import BasePose, turn_upright
from .column import Column
from .contact_checks import refuse_contradictions
from .contacts import contacts_from_switch, contacts_from_wrench, settled
from .default_preparation import ZeroPhase, choose_cutoff
from .differentiation import Kinematics, central_difference, motion_edge, second_difference, smooth_motion
from .filters import ParallelFilter, edge_length, exponential_moving_average, noise_bandwidth, zero_phase
from .link_wrenches import LinkPlacement, link_placement, refuse_unknown_links, wrench_on_link, wrenches_on_links
from .moving_base import base_during
from .opensim import PelvisPose, read_opensim, read_opensim_pelvis
from .opensim_forces import GroundForces, read_opensim_forces
from .poses import Approaches, Poses
from .preparation import FiniteDifference, MovingAverage, Preparation, Smoothed
from .preparation_names import PREPARATIONS, preparation_by_name, register_preparation
from .readers import ReadOptions, register_format
from .recording import Recording
from .recordings import Recordings
from .source import Source
from .torque_delay import without_torque_delay
from .wrench import WRENCH_PARTS, Wrench
from .wrench_frame import WrenchFrame

__all__ = [
    "BASE_COLUMNS",
    "PREPARATIONS",
    "WRENCH_PARTS",
    "Approaches",
    "BaseMotion",
    "BasePose",
    "Column",
    "FiniteDifference",
    "GroundForces",
    "Kinematics",
    "LinkPlacement",
    "MovingAverage",
    "ParallelFilter",
    "PelvisPose",
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
    "base_during",
    "central_difference",
    "choose_cutoff",
    "contacts_from_switch",
    "contacts_from_wrench",
    "datasets",
    "edge_length",
    "exponential_moving_average",
    "link_placement",
    "motion_edge",
    "noise_bandwidth",
    "preparation_by_name",
    "read_opensim",
    "read_opensim_forces",
    "read_opensim_pelvis",
    "refuse_contradictions",
    "refuse_unknown_links",
    "register_format",
    "register_preparation",
    "second_difference",
    "settled",
    "smooth_motion",
    "turn_upright",
    "without_torque_delay",
    "wrench_on_link",
    "wrenches_on_links",
    "zero_phase",
]
