"""Reduction of the torque regressor to base parameters."""

from .planar import Plane

__all__ = ["Plane"]
