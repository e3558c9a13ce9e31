"""Checks of logs and fits: each finds faults that would otherwise pass in silence."""

from .checkup import Checkup, FittedLeg, check_fit, signal_findings, torque_delays
from .repeats import overlaps

__all__ = ["Checkup", "FittedLeg", "check_fit", "overlaps", "signal_findings", "torque_delays"]
