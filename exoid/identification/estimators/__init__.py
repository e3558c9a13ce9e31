"""Estimators: from a problem to parameters."""

from exoid.regression.fit import ols, wls
from exoid.regression.problem import Fit, LeastSquaresProblem

from .by_name import Estimator
from .huber import huber
from .joint_ml import JointML

__all__ = ["Estimator", "Fit", "JointML", "LeastSquaresProblem", "huber", "ols", "wls"]
