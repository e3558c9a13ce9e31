"""Scenarios of a machine on the ground: squats, weight shifts, one foot on the ground, walking, swinging."""

from .machines import bleex_machine, cuhk_machine
from .stance import Stance, single_support, squats_and_shifts, stance_motion, swing
from .walking import walking

__all__ = [
    "Stance",
    "bleex_machine",
    "cuhk_machine",
    "single_support",
    "squats_and_shifts",
    "stance_motion",
    "swing",
    "walking",
]
