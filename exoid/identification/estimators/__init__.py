"""Estimators by name: from a problem to parameters."""

from collections.abc import Mapping

from .fit import Estimator, Fit, Reduced
from .gls import gls
from .huber import huber
from .ols import ols
from .wls import wls

ESTIMATORS: Mapping[str, Estimator] = {"gls": gls, "huber": huber, "ols": ols, "wls": wls}

__all__ = ["ESTIMATORS", "Estimator", "Fit", "Reduced", "gls", "huber", "ols", "wls"]
