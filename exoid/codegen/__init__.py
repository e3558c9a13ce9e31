"""An identified leg as C, for a microcontroller that runs neither Python nor Pinocchio."""

from .dialect import PRECISIONS, Dialect
from .source import CSource, c_source, c_source_to_json, write_c

__all__ = ["PRECISIONS", "CSource", "Dialect", "c_source", "c_source_to_json", "write_c"]
