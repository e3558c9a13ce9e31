"""Linear regression on rows of torque: R factors, noise model, covariance, diagnostics; it knows no leg."""

from .diagnostics import JointNoise
from .least_squares import joint_table, stack
from .parameters import Prior
from .problem import Fit
from .row_data import Rows

__all__ = [
    "Fit",
    "JointNoise",
    "Prior",
    "Rows",
    "joint_table",
    "stack",
]
