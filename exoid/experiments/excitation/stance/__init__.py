"""Optimal excitation on the ground: squats, weight shifts and leg swings whose ground forces are not measured."""

from .files import stance_files, write_stance_plan
from .limits import GroundLimits
from .plan import StancePlan, plan_stance
from .precision import predict_stance
from .rig import run_stance
from .support import StanceSupport

__all__ = [
    "GroundLimits",
    "StancePlan",
    "StanceSupport",
    "plan_stance",
    "predict_stance",
    "run_stance",
    "stance_files",
    "write_stance_plan",
]
