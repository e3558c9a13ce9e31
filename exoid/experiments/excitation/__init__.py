"""Optimal excitation: motions that minimise the standard deviations of the parameters within given limits."""

from .advice import Advice
from .assess import Assessment, assess
from .clearance import Clearance
from .fourier import FourierMotion
from .limits import MotionLimits
from .noise import TorqueNoise
from .plan import Plan, plan_excitation
from .plan_files import plan_files, refuse_plan_name, write_plan
from .precision import Precision, StaticRows, predict
from .scales import Scales
from .stance import (
    GroundLimits,
    StancePlan,
    plan_stance,
    predict_stance,
    run_stance,
    stance_files,
    write_stance_plan,
)
from .text import precision_to_json

__all__ = [
    "Advice",
    "Assessment",
    "Clearance",
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
    "plan_files",
    "plan_stance",
    "precision_to_json",
    "predict",
    "predict_stance",
    "refuse_plan_name",
    "run_stance",
    "stance_files",
    "write_plan",
    "write_stance_plan",
]
