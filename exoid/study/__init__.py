"""Studies: virtual identifications in great number, on one processor or many."""

from .design import LegText, Piece, Study, plausible_truth
from .noise import Noise
from .protocol import Protocol, document, planned
from .replicates import Outcomes, do_piece
from .result import Combination, StudyResult
from .run import run_study
from .workers import Done, Workers, dask_cluster, here, processes

__all__ = [
    "Combination",
    "Done",
    "LegText",
    "Noise",
    "Outcomes",
    "Piece",
    "Protocol",
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
