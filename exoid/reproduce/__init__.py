"""Both documents replayed on virtual rigs: experiments, identification, tables and figures."""

from .bleex import BleexReplay, SideReplay, reproduce_bleex
from .bleex_measurements import Extent
from .cuhk import CuhkReplay, reproduce_cuhk
from .figures import make_folder, write_bleex_figures, write_cuhk_figures
from .report import bleex_json, bleex_text, cuhk_json, cuhk_text

__all__ = [
    "BleexReplay",
    "CuhkReplay",
    "Extent",
    "SideReplay",
    "bleex_json",
    "bleex_text",
    "cuhk_json",
    "cuhk_text",
    "make_folder",
    "reproduce_bleex",
    "reproduce_cuhk",
    "write_bleex_figures",
    "write_cuhk_figures",
]
