"""Stability of a leg under a law: what document 2 proves, what follows from it, and where it ends."""

from .equilibrium import Equilibrium, find_equilibrium
from .gain_margin import GainMargins, gain_margins, spectral_radius
from .limit_cycle import LimitCycle, find_limit_cycle
from .lyapunov import Lyapunov, lyapunov
from .properties import ModelProperties, check_properties
from .regulation import Regulation, Regulations, regulate

__all__ = [
    "Equilibrium",
    "GainMargins",
    "LimitCycle",
    "Lyapunov",
    "ModelProperties",
    "Regulation",
    "Regulations",
    "check_properties",
    "find_equilibrium",
    "find_limit_cycle",
    "gain_margins",
    "lyapunov",
    "regulate",
    "spectral_radius",
]
