"""From recordings to parameters: how they are found."""

from .check import check
from .identify import identify
from .selection import Selection, select_terms

__all__ = ["Selection", "check", "identify", "select_terms"]
