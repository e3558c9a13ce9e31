"""Both documents replayed on virtual rigs: experiments, identification, tables and figures."""

from .bleex import Replay, SideReplay, reproduce_bleex
from .cuhk import CuhkReplay, reproduce_cuhk
from .figures import write_bleex_figures, write_cuhk_figures
from .report import bleex_json, bleex_text, cuhk_json, cuhk_text

__all__ = [
    "CuhkReplay",
    "Replay",
    "SideReplay",
    "bleex_json",
    "bleex_text",
    "cuhk_json",
    "cuhk_text",
    "reproduce_bleex",
    "reproduce_cuhk",
    "write_bleex_figures",
    "write_cuhk_figures",
]
