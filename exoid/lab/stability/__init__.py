"""Stability of a leg under a controller: where it rests, how much gain it bears, and a worn leg with a wrong model."""

from .figure import plot_gain_margins, plot_regulation_errors
from .gain_margin import gain_margins
from .regulation import regulate
from .rest import find_equilibrium, find_limit_cycle
from .worn.amplification import Amplification, largest_amplification

__all__ = [
    "Amplification",
    "find_equilibrium",
    "find_limit_cycle",
    "gain_margins",
    "largest_amplification",
    "plot_gain_margins",
    "plot_regulation_errors",
    "regulate",
]
