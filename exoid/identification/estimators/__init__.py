"""Estimators: from a problem to parameters."""

from exoid.regression.fit import Fit, ols, wls
from exoid.regression.problem import LeastSquaresProblem

from .by_name import Estimator, register_estimator
from .closed_loop import ClosedLoop
from .gls import gls
from .huber import huber
from .joint_ml import JointML
from .output_error import OutputError

__all__ = [
    "ClosedLoop",
    "Estimator",
    "Fit",
    "JointML",
    "LeastSquaresProblem",
    "OutputError",
    "gls",
    "huber",
    "ols",
    "register_estimator",
    "wls",
]
