"""Stability of a worn leg under a controller with a wrong model."""

from .amplification import Amplification, largest_amplification

__all__ = [
    "Amplification",
    "largest_amplification",
]
