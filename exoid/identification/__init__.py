"""From recordings to parameters: how they are found."""

from .estimators import ESTIMATORS
from .identify import identify
from .selection import Candidate, Selection, select_terms
from .together import Together, identify_together

__all__ = [
    "ESTIMATORS",
    "Candidate",
    "Selection",
    "Together",
    "identify",
    "identify_together",
    "select_terms",
]
