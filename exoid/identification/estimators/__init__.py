"""Estimators: from a problem to parameters."""

from exoid.regression.fit import Fit, ols, wls
from exoid.regression.problem import LeastSquaresProblem

from .by_name import ESTIMATORS, Estimator, find_estimator, fit_by, name_of, register_estimator
from .closed_loop import ClosedLoop
from .gls import gls
from .huber import huber
from .joint_ml import JointML
from .output_error import OutputError

__all__ = [
    "ESTIMATORS",
    "ClosedLoop",
    "Estimator",
    "Fit",
    "JointML",
    "LeastSquaresProblem",
    "OutputError",
    "find_estimator",
    "fit_by",
    "gls",
    "huber",
    "name_of",
    "ols",
    "register_estimator",
    "wls",
]
