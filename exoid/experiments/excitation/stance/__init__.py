"""Optimal excitation on the ground: squats, weight shifts and leg swings whose ground forces are not measured."""

from .demands import GroundLimits
from .plan import StancePlan, plan_stance
from .rig import run_stance

__all__ = ["GroundLimits", "StancePlan", "plan_stance", "run_stance"]
