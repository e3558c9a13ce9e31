"""Recursive estimation: parameters of a leg from a stream of samples, while it moves."""

from .estimator import RecursiveEstimator
from .load import LoadChange, load_change
from .state import Change, Drift

__all__ = ["Change", "Drift", "LoadChange", "RecursiveEstimator", "load_change"]
