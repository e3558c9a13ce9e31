"""Scenarios of a machine on the ground: squats, weight shifts, one foot on the ground, walking, swinging."""

from .machines import bleex_machine
from .stance import Stance, rail_squats, single_support, squats_and_shifts, swing
from .walking import Gait, walking

__all__ = ["Gait", "Stance", "bleex_machine", "rail_squats", "single_support", "squats_and_shifts", "swing", "walking"]
