"""Scenarios of a machine on the ground: squats, weight shifts, one foot on the ground, walking, swinging."""

from .machines import bleex_machine
from .stance import HAND_RAIL, Stance, rail_squats, single_support, squats_and_shifts
from .swing import CLAMP, swing
from .walking import HARNESS, Gait, walking

__all__ = [
    "CLAMP",
    "HAND_RAIL",
    "HARNESS",
    "Gait",
    "Stance",
    "bleex_machine",
    "rail_squats",
    "single_support",
    "squats_and_shifts",
    "swing",
    "walking",
]
