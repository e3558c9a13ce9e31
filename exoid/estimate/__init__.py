"""The result of an identification: values with intervals, files, text, comparison, validation, export."""

from .compared import TorqueFilter
from .comparison import Comparison, compare
from .data import EstimateData
from .estimate import Estimate
from .evidence import Evidence
from .export import Export
from .ground_prediction import GroundForce, ground_forces
from .grouped import GroupedEstimate
from .mjcf import MjcfExport
from .model_error import ModelError, TorqueBand
from .nonlinear import NonlinearParameters
from .parameter import Parameter
from .validation import Validation, validate

__all__ = [
    "Comparison",
    "Estimate",
    "EstimateData",
    "Evidence",
    "Export",
    "GroundForce",
    "GroupedEstimate",
    "MjcfExport",
    "ModelError",
    "NonlinearParameters",
    "Parameter",
    "TorqueBand",
    "TorqueFilter",
    "Validation",
    "compare",
    "ground_forces",
    "validate",
]
