"""Linear regression on rows of torque: R factors, noise model, covariance, diagnostics."""

from .diagnostics import JointNoise
from .influence import Influence
from .parameters import Prior
from .trends import Trend

__all__ = ["Influence", "JointNoise", "Prior", "Trend"]
