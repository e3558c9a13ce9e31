"""Optimal excitation: motions that minimise the standard deviations of the parameters within given limits."""

from exoid.experiments.limits import MotionLimits

from .assess import Assessment, assess
from .plan import Plan, plan_excitation
from .stance import StancePlan, plan_stance, run_stance
from .supports import Supports, determined_on

__all__ = [
    "Assessment",
    "MotionLimits",
    "Plan",
    "StancePlan",
    "Supports",
    "assess",
    "determined_on",
    "plan_excitation",
    "plan_stance",
    "run_stance",
]
