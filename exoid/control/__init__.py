"""Controllers for an identified leg, and the closed loop with a virtual rig."""

from .closed_loop import simulate, simulate_many
from .compare_laws import compare_laws
from .computed_torque import computed_torque
from .driven import Driven
from .feedforward_pd import feedforward_pd
from .friction import AHEAD, SHARP, SMOOTH, FrictionCompensation
from .gravity_friction_pd import gravity_friction_pd
from .law import Law, State
from .limited import Limited
from .lqr import Weights, lqr
from .mean_pose import mean_pose
from .model import ControlModel
from .pd import p, pd
from .side_by_side import SideBySide
from .standard_laws import LAWS, default_gains, standard_laws
from .stateful import StatefulLaw, stateful
from .track import track
from .tracking import Tracking, command_table

__all__ = [
    "AHEAD",
    "LAWS",
    "SHARP",
    "SMOOTH",
    "ControlModel",
    "Driven",
    "FrictionCompensation",
    "Law",
    "Limited",
    "SideBySide",
    "State",
    "StatefulLaw",
    "Tracking",
    "Weights",
    "command_table",
    "compare_laws",
    "computed_torque",
    "default_gains",
    "feedforward_pd",
    "gravity_friction_pd",
    "lqr",
    "mean_pose",
    "p",
    "pd",
    "simulate",
    "simulate_many",
    "standard_laws",
    "stateful",
    "track",
]
