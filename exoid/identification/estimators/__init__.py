"""Estimators by name: from a problem to parameters."""

from collections.abc import Mapping

from .closed_loop import ClosedLoop
from .fit import Estimator, Fit, Reduced, name_of
from .gls import gls
from .huber import huber
from .instrumental import InstrumentalVariables
from .joint_ml import JointML
from .ols import ols
from .output_error import OutputError
from .wls import wls

ESTIMATORS: Mapping[str, Estimator] = {"gls": gls, "huber": huber, "ml": JointML(), "ols": ols, "wls": wls}
"""Estimators that need no settings."""

NEED_LOOP: Mapping[str, Estimator] = {"iv": InstrumentalVariables(), "output-error": OutputError()}
"""Estimators that need a :class:`ClosedLoop`, and say so when they are used without."""

__all__ = [
    "ESTIMATORS",
    "NEED_LOOP",
    "ClosedLoop",
    "Estimator",
    "Fit",
    "InstrumentalVariables",
    "JointML",
    "OutputError",
    "Reduced",
    "gls",
    "huber",
    "name_of",
    "ols",
    "wls",
]
