"""Replays of both documents on virtual rigs: experiments, identification, tables and figures."""

from .bleex import BleexReplay, SideReplay, reproduce_bleex
from .bleex_measurements import Extent
from .cuhk import CuhkReplay, reproduce_cuhk
from .cuhk_tracking import TrackingReplay, reproduce_cuhk_tracking
from .figures import bleex_figures, cuhk_figures
from .pages import bleex_page, cuhk_page, tracking_page
from .report import bleex_json, bleex_text, cuhk_json, cuhk_text
from .tracking_report import (
    cuhk_tracking_json,
    cuhk_tracking_notes,
    cuhk_tracking_table,
    cuhk_tracking_text,
    laws_json,
    tracking_figures,
)

__all__ = [
    "BleexReplay",
    "CuhkReplay",
    "Extent",
    "SideReplay",
    "TrackingReplay",
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
    "tracking_figures",
    "tracking_page",
]
