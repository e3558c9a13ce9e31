"""Optimal excitation: motions that minimise the standard deviations of the parameters within given limits."""

from .advice import Advice
from .assess import Assessment, assess
from .fourier import FourierMotion
from .limits import MotionLimits
from .noise import TorqueNoise
from .plan import Plan, plan_excitation
from .precision import Precision, StaticRows, predict
from .scales import Scales
from .stance import GroundLimits, StancePlan, plan_stance, run_stance

__all__ = [
    "Advice",
    "Assessment",
    "FourierMotion",
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
