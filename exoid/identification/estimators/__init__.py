"""Estimators: from a problem to parameters."""

from exoid.identification.stacked import Reduced

from .by_name import ESTIMATORS, find_estimator
from .closed_loop import ClosedLoop
from .fit import Estimator, Fit, name_of
from .gls import gls
from .huber import huber
from .joint_ml import JointML
from .ols import ols
from .output_error import OutputError
from .wls import wls

__all__ = [
    "ESTIMATORS",
    "ClosedLoop",
    "Estimator",
    "Fit",
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
