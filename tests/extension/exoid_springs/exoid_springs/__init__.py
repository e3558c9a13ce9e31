"""Two terms, a log format, an estimator and a preparation for exoid."""

from .biarticular import Biarticular
from .end_stop import EndStop
from .lab_log import read_lab
from .mad import mad
from .median import Median

__all__ = ["Biarticular", "EndStop", "Median", "mad", "read_lab"]
