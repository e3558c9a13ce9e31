"""Two terms and an estimator for exoid."""

from .biarticular import Biarticular
from .end_stop import EndStop
from .mad import mad

__all__ = ["Biarticular", "EndStop", "mad"]
