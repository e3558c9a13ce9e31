"""Studies: virtual identifications in great number, and control laws told by them, on one processor or many."""

from .design import Chunk, Driver, LegText, Study, plausible_truth
from .law_figures import LawFigures, Spread
from .noise import Noise
from .protocol import Protocol, document, planned
from .replicates import Outcomes, run_chunk
from .result import Combination, StudyResult
from .run import run_study
from .tracking_task import TrackingTask
from .workers import Done, Workers, dask_cluster, processes, run_serially

__all__ = [
    "Chunk",
    "Combination",
    "Done",
    "Driver",
    "LawFigures",
    "LegText",
    "Noise",
    "Outcomes",
    "Protocol",
    "Spread",
    "Study",
    "StudyResult",
    "TrackingTask",
    "Workers",
    "dask_cluster",
    "document",
    "planned",
    "plausible_truth",
    "processes",
    "run_chunk",
    "run_serially",
    "run_study",
]
