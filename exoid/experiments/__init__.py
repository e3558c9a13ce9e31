"""Experiments: protocols of both documents as data, references, and execution on virtual rigs."""

from . import bleex, cuhk, ground
from .bench import Bench
from .followed_log import follow_log
from .gait import gait_for_leg, healthy_gait
from .references import Approach, Harmonics, Hold, fit_harmonics
from .static import StaticProtocol, run_static

__all__ = [
    "Approach",
    "Bench",
    "Harmonics",
    "Hold",
    "StaticProtocol",
    "bleex",
    "cuhk",
    "fit_harmonics",
    "follow_log",
    "gait_for_leg",
    "ground",
    "healthy_gait",
    "run_static",
]
