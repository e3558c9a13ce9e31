"""Terms, filter and estimator chosen by how well they predict what they were not fitted to."""

from .by_joint import JointFriction
from .candidates import Candidate, estimator_candidates, filter_candidates, friction_candidates
from .scores import Score
from .selection import Selection, select_terms

__all__ = [
    "Candidate",
    "JointFriction",
    "Score",
    "Selection",
    "estimator_candidates",
    "filter_candidates",
    "friction_candidates",
    "select_terms",
]
