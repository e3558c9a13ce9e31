"""Stability of a worn leg: what the controller's model must know how well."""

from .amplification import Amplification, AmplifiedLaw, largest_amplification
from .better_experiments import BetterExperiments, better_experiments
from .probability import StabilityProbability, stability_probability

__all__ = [
    "Amplification",
    "AmplifiedLaw",
    "BetterExperiments",
    "StabilityProbability",
    "better_experiments",
    "largest_amplification",
    "stability_probability",
]
