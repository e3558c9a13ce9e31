"""An end stop, a log format, an estimator and a preparation for exoid."""

from .end_stop import EndStop
from .lab_log import read_lab
from .mad import mad
from .median import Median

__all__ = ["EndStop", "Median", "mad", "read_lab"]
