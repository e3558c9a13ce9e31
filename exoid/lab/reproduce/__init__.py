"""Replays of both documents on virtual rigs, and a study of stance: experiments, tables and figures."""

from .bleex import BleexReplay, SideReplay, reproduce_bleex
from .bleex_measurements import Extent
from .cuhk import CuhkReplay, reproduce_cuhk
from .cuhk_tracking import TrackingReplay, reproduce_cuhk_tracking
from .figures import bleex_figures, cuhk_figures
from .pages import bleex_page, cuhk_page, tracking_page
from .report import bleex_json, bleex_text, cuhk_json, cuhk_text
from .stance import StanceReplay, reproduce_stance
from .stance_logs import StanceExtent
from .stance_report import stance_figures, stance_json, stance_page, stance_text
from .tracking_report import (
    cuhk_tracking_json,
    cuhk_tracking_notes,
    cuhk_tracking_table,
    cuhk_tracking_text,
    laws_json,
    tracking_figures,
)
from .wear_report import wear_figures, wear_json, wear_page, wear_text
from .wear_study import Felt, WearStudy, wear

__all__ = [
    "BleexReplay",
    "CuhkReplay",
    "Extent",
    "Felt",
    "SideReplay",
    "StanceExtent",
    "StanceReplay",
    "TrackingReplay",
    "WearStudy",
    "bleex_figures",
    "bleex_json",
    "bleex_page",
    "bleex_text",
    "cuhk_figures",
    "cuhk_json",
    "cuhk_page",
    "cuhk_text",
    "cuhk_tracking_json",
    "cuhk_tracking_notes",
    "cuhk_tracking_table",
    "cuhk_tracking_text",
    "laws_json",
    "reproduce_bleex",
    "reproduce_cuhk",
    "reproduce_cuhk_tracking",
    "reproduce_stance",
    "stance_figures",
    "stance_json",
    "stance_page",
    "stance_text",
    "tracking_figures",
    "tracking_page",
    "wear",
    "wear_figures",
    "wear_json",
    "wear_page",
    "wear_text",
]
