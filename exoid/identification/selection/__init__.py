"""Friction of each joint, filter and estimator chosen by how well they predict what they were not fitted to."""

from .selection import Selection, select_terms

__all__ = ["Selection", "select_terms"]
