"""From recordings to parameters with their uncertainty, and how well these predict."""

from .assumed import Prior
from .bands import TorqueBand
from .comparison import Comparison, compare, comparison_to_json
from .diagnostics import JointNoise
from .estimate import Estimate, Input
from .estimate_file import estimate_from_json, estimate_to_json
from .estimators import ESTIMATORS
from .export import Export
from .identify import identify
from .influence import Influence
from .prediction import predict_motion
from .selection import Candidate, Selection, select_terms
from .shapes import Shapes
from .together import Together, identify_together
from .trends import Trend
from .validation import Validation, validate, validation_to_json

__all__ = [
    "ESTIMATORS",
    "Candidate",
    "Comparison",
    "Estimate",
    "Export",
    "Influence",
    "Input",
    "JointNoise",
    "Prior",
    "Selection",
    "Shapes",
    "Together",
    "TorqueBand",
    "Trend",
    "Validation",
    "compare",
    "comparison_to_json",
    "estimate_from_json",
    "estimate_to_json",
    "identify",
    "identify_together",
    "predict_motion",
    "select_terms",
    "validate",
    "validation_to_json",
]
