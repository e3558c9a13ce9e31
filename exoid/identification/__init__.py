"""From recordings to parameters: how they are found."""

from .estimators import ESTIMATORS, register_estimator
from .identify import identify
from .selection import Candidate, Selection, select_terms

__all__ = [
    "ESTIMATORS",
    "Candidate",
    "Selection",
    "identify",
    "register_estimator",
    "select_terms",
]
