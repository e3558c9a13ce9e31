"""Scenarios of a machine on the ground."""

from .stance import HAND_RAIL, Stance, rail_squats, single_support, squats_and_shifts

__all__ = ["HAND_RAIL", "Stance", "rail_squats", "single_support", "squats_and_shifts"]
