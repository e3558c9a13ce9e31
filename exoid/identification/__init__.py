"""From recordings to parameters: how they are found."""

from .check import check
from .estimators import ESTIMATORS, register_estimator
from .identify import identify
from .selection import Candidate, Selection, select_terms

__all__ = [
    "ESTIMATORS",
    "Candidate",
    "Selection",
    "check",
    "identify",
    "register_estimator",
    "select_terms",
]
