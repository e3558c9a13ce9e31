"""Studies: many virtual identifications, and controllers that use the estimates, on one processor or many."""

from .design import Chunk, LegText, Study, TrackingCase, plausible_truth
from .noise import Noise
from .protocol import Protocol, document, planned
from .replicates import Outcomes, run_chunk
from .result import Combination, StudyResult
from .run import run_study
from .tracking_statistics import Spread, TrackingStatistics
from .tracking_task import TrackingTask
from .workers import Done, Workers, joblib_backend, processes, run_serially

__all__ = [
    "Chunk",
    "Combination",
    "Done",
    "LegText",
    "Noise",
    "Outcomes",
    "Protocol",
    "Spread",
    "Study",
    "StudyResult",
    "TrackingCase",
    "TrackingStatistics",
    "TrackingTask",
    "Workers",
    "document",
    "joblib_backend",
    "planned",
    "plausible_truth",
    "processes",
    "run_chunk",
    "run_serially",
    "run_study",
]
