"""Stability of a leg under a controller: how much gain it bears, and a worn leg with a wrong model."""

from .gain_margin import gain_margins, plot_gain_margins
from .worn.amplification import Amplification, largest_amplification

__all__ = [
    "Amplification",
    "gain_margins",
    "largest_amplification",
    "plot_gain_margins",
]
