"""Both documents replayed on virtual rigs: experiments, identification, tables and figures."""

from .bleex import BleexReplay, SideReplay, reproduce_bleex
from .bleex_measurements import Extent
from .cuhk import CuhkReplay, reproduce_cuhk
from .cuhk_tracking import TrackingReplay, reproduce_cuhk_tracking
from .figures import make_folder, write_bleex_figures, write_cuhk_figures
from .report import bleex_json, bleex_text, cuhk_json, cuhk_text
from .tracking_report import cuhk_tracking_json, cuhk_tracking_text, laws_json, write_tracking_figures

__all__ = [
    "BleexReplay",
    "CuhkReplay",
    "Extent",
    "SideReplay",
    "TrackingReplay",
    "bleex_json",
    "bleex_text",
    "cuhk_json",
    "cuhk_text",
    "cuhk_tracking_json",
    "cuhk_tracking_text",
    "laws_json",
    "make_folder",
    "reproduce_bleex",
    "reproduce_cuhk",
    "reproduce_cuhk_tracking",
    "write_bleex_figures",
    "write_cuhk_figures",
    "write_tracking_figures",
]
