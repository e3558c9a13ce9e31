"""From recordings to parameters: how they are found."""

from .estimators import ESTIMATORS
from .identify import identify
from .selection import Candidate, Selection, select_terms

__all__ = [
    "ESTIMATORS",
    "Candidate",
    "Selection",
    "identify",
    "select_terms",
]
