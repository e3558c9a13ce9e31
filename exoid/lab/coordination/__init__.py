"""Coordination of functions over a day on the virtual rig: the day, its study and its report."""

from .day import Episode, run_day
from .report import coordination_report
from .study import CoordinationStudy, calibrate, coordinate

__all__ = ["CoordinationStudy", "Episode", "calibrate", "coordinate", "coordination_report", "run_day"]
