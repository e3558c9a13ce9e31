"""A control law as C99 for a microcontroller: header and source, with limits, watchdog and safe torque."""

from .law_in_c import MOTION, REFERENCE, ArrayInC, InputInC, LawInC, LegInC, Needed
from .safety import Safety
from .source import LawSource
from .write import law_source, write_law

__all__ = [
    "MOTION",
    "REFERENCE",
    "ArrayInC",
    "InputInC",
    "LawInC",
    "LawSource",
    "LegInC",
    "Needed",
    "Safety",
    "law_source",
    "write_law",
]
