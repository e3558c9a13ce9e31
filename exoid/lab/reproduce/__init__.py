"""Replays of both documents on virtual rigs, and studies of stance and of wearing: experiments, tables and figures."""

from .bleex import reproduce_bleex
from .bleex_measurements import Extent
from .bleex_report import bleex_report
from .cuhk import reproduce_cuhk
from .cuhk_report import cuhk_report
from .cuhk_tracking import reproduce_cuhk_tracking
from .report import ReplayReport
from .stance import reproduce_stance
from .stance_logs import StanceExtent
from .stance_report import stance_report
from .wear_report import wear_report
from .wear_study import wear

__all__ = [
    "Extent",
    "ReplayReport",
    "StanceExtent",
    "bleex_report",
    "cuhk_report",
    "reproduce_bleex",
    "reproduce_cuhk",
    "reproduce_cuhk_tracking",
    "reproduce_stance",
    "stance_report",
    "wear",
    "wear_report",
]
