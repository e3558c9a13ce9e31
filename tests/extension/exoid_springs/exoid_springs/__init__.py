"""A term and an estimator for exoid."""

from .end_stop import EndStop
from .mad import mad

__all__ = ["EndStop", "mad"]
