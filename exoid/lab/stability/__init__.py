"""Stability of a leg under a controller: document 2's proof and its limits; a worn leg with a wrong model."""

from .figure import plot_gain_margins, plot_lyapunov, plot_regulation_errors
from .gain_margin import gain_margins
from .lyapunov import lyapunov
from .properties import check_properties
from .regulation import regulate
from .rest import find_equilibrium, find_limit_cycle
from .worn.amplification import Amplification, largest_amplification
from .worn.probability import stability_probability

__all__ = [
    "Amplification",
    "check_properties",
    "find_equilibrium",
    "find_limit_cycle",
    "gain_margins",
    "largest_amplification",
    "lyapunov",
    "plot_gain_margins",
    "plot_lyapunov",
    "plot_regulation_errors",
    "regulate",
    "stability_probability",
]
