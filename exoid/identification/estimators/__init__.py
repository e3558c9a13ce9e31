"""Estimators: from a problem to parameters."""

from exoid.regression.problem import Reduced

from .by_name import ESTIMATORS, find_estimator
from .closed_loop import ClosedLoop
from .fit import Estimator, Fit, name_of
from .gls import gls
from .huber import huber
from .instrumental import InstrumentalVariables
from .joint_ml import JointML
from .ols import ols
from .output_error import OutputError
from .wls import wls

__all__ = [
    "ESTIMATORS",
    "ClosedLoop",
    "Estimator",
    "Fit",
    "InstrumentalVariables",
    "JointML",
    "OutputError",
    "Reduced",
    "find_estimator",
    "gls",
    "huber",
    "name_of",
    "ols",
    "wls",
]
