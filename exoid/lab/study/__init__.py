"""Studies: many virtual identifications, on one processor or many."""

from .design import LegText, Study, plausible_truth
from .noise import Noise
from .protocol import Protocol, document, planned
from .run import run_study

__all__ = [
    "LegText",
    "Noise",
    "Protocol",
    "Study",
    "document",
    "planned",
    "plausible_truth",
    "run_study",
]
