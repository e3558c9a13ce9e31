"""Studies: virtual identifications in great number, and control laws told by them, on one processor or many."""

from .design import Driver, LegText, Piece, Study, plausible_truth
from .law_figures import LawFigures, Spread
from .noise import Noise
from .protocol import Protocol, document, planned
from .replicates import Outcomes, do_piece
from .result import Combination, StudyResult
from .run import run_study
from .tracking_task import Course
from .workers import Done, Workers, dask_cluster, here, processes

__all__ = [
    "Combination",
    "Course",
    "Done",
    "Driver",
    "LawFigures",
    "LegText",
    "Noise",
    "Outcomes",
    "Piece",
    "Protocol",
    "Spread",
    "Study",
    "StudyResult",
    "Workers",
    "dask_cluster",
    "do_piece",
    "document",
    "here",
    "planned",
    "plausible_truth",
    "processes",
    "run_study",
]
