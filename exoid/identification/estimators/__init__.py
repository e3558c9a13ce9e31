"""Estimators: from a problem to parameters."""

from exoid.regression.fit import Fit
from exoid.regression.problem import LeastSquaresProblem

from .by_name import ESTIMATORS, Estimator, find_estimator, name_of
from .closed_loop import ClosedLoop
from .gls import gls
from .huber import huber
from .instrumental import InstrumentalVariables
from .joint_ml import JointML
from .least_squares import ols, wls
from .output_error import OutputError

__all__ = [
    "ESTIMATORS",
    "ClosedLoop",
    "Estimator",
    "Fit",
    "InstrumentalVariables",
    "JointML",
    "LeastSquaresProblem",
    "OutputError",
    "find_estimator",
    "gls",
    "huber",
    "name_of",
    "ols",
    "wls",
]
