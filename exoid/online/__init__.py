"""Recursive estimation: parameters of a leg from a stream of samples, while it moves."""

from .advance import Recursion, advance
from .belief import belief
from .estimator import RecursiveEstimator
from .hypotheses import Hypothesis, hypotheses_of
from .load import LoadChange, load_change
from .rows import Block
from .settings import Settings
from .solution import estimate_of
from .start import started
from .state import Change, Drift, State

__all__ = [
    "Block",
    "Change",
    "Drift",
    "Hypothesis",
    "LoadChange",
    "Recursion",
    "RecursiveEstimator",
    "Settings",
    "State",
    "advance",
    "belief",
    "estimate_of",
    "hypotheses_of",
    "load_change",
    "started",
]
