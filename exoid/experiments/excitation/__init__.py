"""Optimal excitation: motions that minimise the standard deviations of the parameters within given limits."""

from .assess import Assessment, assess
from .limits import MotionLimits
from .plan import Plan, plan_excitation
from .precision import Precision, StaticRows, predict
from .scales import Scales, TorqueNoise
from .stance import GroundLimits, StancePlan, plan_stance, run_stance

__all__ = [
    "Assessment",
    "GroundLimits",
    "MotionLimits",
    "Plan",
    "Precision",
    "Scales",
    "StancePlan",
    "StaticRows",
    "TorqueNoise",
    "assess",
    "plan_excitation",
    "plan_stance",
    "predict",
    "run_stance",
]
