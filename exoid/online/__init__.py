"""Recursive estimation: parameters of a leg from a stream of samples, while it moves."""

from .estimator import RecursiveEstimator
from .load import LoadChange, load_change
from .state import Change

__all__ = ["Change", "LoadChange", "RecursiveEstimator", "load_change"]
