"""Both documents replayed on virtual rigs: experiments, identification, tables and figures."""

from .bleex import BleexReplay, SideReplay, reproduce_bleex
from .bleex_measurements import Extent
from .cuhk import CuhkReplay, reproduce_cuhk
from .figures import bleex_figures, cuhk_figures, make_folder, write_figures
from .pages import bleex_page, cuhk_page
from .report import bleex_json, bleex_text, cuhk_json, cuhk_text

__all__ = [
    "BleexReplay",
    "CuhkReplay",
    "Extent",
    "SideReplay",
    "bleex_figures",
    "bleex_json",
    "bleex_page",
    "bleex_text",
    "cuhk_figures",
    "cuhk_json",
    "cuhk_page",
    "cuhk_text",
    "make_folder",
    "reproduce_bleex",
    "reproduce_cuhk",
    "write_figures",
]
