"""Stability of a leg under a controller: document 2's proof and its limits; a worn leg with a wrong model."""

from .equilibrium import Equilibrium, find_equilibrium
from .figure import plot_gain_margins, plot_lyapunov, plot_regulation_errors
from .gain_margin import GainMargins, gain_margins, spectral_radius
from .limit_cycle import LimitCycle, find_limit_cycle
from .lyapunov import Lyapunov, lyapunov
from .properties import ModelProperties, check_properties
from .regulation import Regulation, Regulations, regulate
from .worn import (
    Amplification,
    BetterExperiments,
    StabilityProbability,
    better_experiments,
    largest_amplification,
    stability_probability,
)

__all__ = [
    "Amplification",
    "BetterExperiments",
    "Equilibrium",
    "GainMargins",
    "LimitCycle",
    "Lyapunov",
    "ModelProperties",
    "Regulation",
    "Regulations",
    "StabilityProbability",
    "better_experiments",
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
    "spectral_radius",
    "stability_probability",
]
