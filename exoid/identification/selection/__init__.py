"""Friction of each joint, chosen by how well it predicts what it was not fitted to."""

from .selection import Selection, select_terms

__all__ = ["Selection", "select_terms"]
