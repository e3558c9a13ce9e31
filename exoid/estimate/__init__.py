"""The result of an identification: values with intervals, files, text, comparison, validation, prediction, export."""

from .comparison import Comparison, compare, comparison_to_json
from .data import EstimateData, Input
from .estimate import Estimate, estimate_from_json
from .export import Export
from .file import estimate_to_json
from .grouped import GroupedEstimate, grouped_to_json
from .nonlinear import NonlinearParameters
from .parameter import Parameter
from .prediction import predict_motion
from .torque_band import TorqueBand
from .validation import Validation, validate, validation_to_json

__all__ = [
    "Comparison",
    "Estimate",
    "EstimateData",
    "Export",
    "GroupedEstimate",
    "Input",
    "NonlinearParameters",
    "Parameter",
    "TorqueBand",
    "Validation",
    "compare",
    "comparison_to_json",
    "estimate_from_json",
    "estimate_to_json",
    "grouped_to_json",
    "predict_motion",
    "validate",
    "validation_to_json",
]
