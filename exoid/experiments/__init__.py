"""Experiments: protocols of both documents as data, references, and execution on virtual rigs."""

from . import bleex, cuhk, ground
from .bench import Bench, stiff_servo
from .dynamic import run_motion
from .followed_log import FollowedLog, follow_log
from .fourier import fit_harmonics
from .gait import gait_for_leg, healthy_gait, joint_roles, norm_gait
from .intentions import Stumble, Tremor
from .limits import refuse_motion_beyond_limits, refuse_poses_beyond_limits
from .protocol_files import read_static_log, write_motion, write_static_log, write_static_protocol
from .references import Approach, Harmonics, Hold
from .static import StaticProtocol, run_static

__all__ = [
    "Approach",
    "Bench",
    "FollowedLog",
    "Harmonics",
    "Hold",
    "StaticProtocol",
    "Stumble",
    "Tremor",
    "bleex",
    "cuhk",
    "fit_harmonics",
    "follow_log",
    "gait_for_leg",
    "ground",
    "healthy_gait",
    "joint_roles",
    "norm_gait",
    "read_static_log",
    "refuse_motion_beyond_limits",
    "refuse_poses_beyond_limits",
    "run_motion",
    "run_static",
    "stiff_servo",
    "write_motion",
    "write_static_log",
    "write_static_protocol",
]
