"""Terms, filter and estimator chosen by how well they predict what they were not fitted to."""

from .candidates import Candidate, estimator_candidates, filter_candidates, friction_candidates
from .selection import Score, Selection, select_terms

__all__ = [
    "Candidate",
    "Score",
    "Selection",
    "estimator_candidates",
    "filter_candidates",
    "friction_candidates",
    "select_terms",
]
