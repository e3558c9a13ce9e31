"""Studies: many virtual identifications, and controllers that use the estimates, on one processor or many."""

from .design import LegText, Study, plausible_truth
from .noise import Noise
from .protocol import Protocol, document, planned
from .run import run_study
from .tracking_task import TrackingTask

__all__ = [
    "LegText",
    "Noise",
    "Protocol",
    "Study",
    "TrackingTask",
    "document",
    "planned",
    "plausible_truth",
    "run_study",
]
