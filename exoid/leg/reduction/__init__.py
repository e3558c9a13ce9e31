"""Reduction of the torque regressor to base parameters."""

from .planar import Plane
from .reduction import RankDecision, Reduction

__all__ = [
    "Plane",
    "RankDecision",
    "Reduction",
]
