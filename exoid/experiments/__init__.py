"""The documents' protocols as data, and running them on virtual rigs."""

from . import bleex
from .references import Approach, Harmonics, Hold
from .static import Bench, StaticProtocol, run_static

__all__ = ["Approach", "Bench", "Harmonics", "Hold", "StaticProtocol", "bleex", "run_static"]
