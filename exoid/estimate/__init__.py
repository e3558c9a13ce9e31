"""The result of an identification: values with intervals, files, text, comparison, validation, prediction, export."""

from .comparison import Comparison, compare, comparison_to_json
from .estimate import Estimate, Input
from .export import Export
from .file import estimate_from_json, estimate_to_json
from .nonlinear import Shapes
from .prediction import predict_motion
from .torque_band import TorqueBand
from .validation import Validation, validate, validation_to_json

__all__ = [
    "Comparison",
    "Estimate",
    "Export",
    "Input",
    "Shapes",
    "TorqueBand",
    "Validation",
    "compare",
    "comparison_to_json",
    "estimate_from_json",
    "estimate_to_json",
    "predict_motion",
    "validate",
    "validation_to_json",
]
