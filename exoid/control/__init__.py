"""Control laws on an identified leg, and the closed loop with a virtual rig."""

from .closed_loop import simulate, simulate_many
from .friction import AHEAD, SHARP, SMOOTH, FrictionCompensation
from .gravity_friction_pd import GravityFrictionPD, gravity_friction_pd
from .law import Law, State
from .model import ControlModel
from .pd import PD, p, pd
from .side_by_side import SideBySide
from .tracking import Tracking, tracking_table, tracking_to_json

__all__ = [
    "AHEAD",
    "PD",
    "SHARP",
    "SMOOTH",
    "ControlModel",
    "FrictionCompensation",
    "GravityFrictionPD",
    "Law",
    "SideBySide",
    "State",
    "Tracking",
    "gravity_friction_pd",
    "p",
    "pd",
    "simulate",
    "simulate_many",
    "tracking_table",
    "tracking_to_json",
]
