"""Controllers for an identified leg, and the closed loop with a virtual rig."""

from . import functions as functions
from . import ground as ground
from . import wearer as wearer
from .closed_loop import compare_laws, simulate_law, simulate_many
from .friction import AHEAD, PASSIVE, SHARP, SMOOTH, FrictionCompensation
from .ground import stance
from .law import Law, State, StatefulLaw, stateful
from .laws import (
    computed_torque,
    feedforward_pd,
    gravity_friction_pd,
    gravity_support,
    impedance,
    pd,
)
from .limited import Limited
from .lqr import lqr
from .model import ControlModel, default_gains
from .observers import MomentumObserver, SensorNoise
from .replay import LawReplay, replay_law
from .self_tuning import self_tuning
from .sensitivity_amplification import sensitivity_amplification
from .standard_laws import LAWS, mean_pose, standard_laws
from .toe_clearance import ToeClearance, toe_clearance
from .tracking import Tracking

__all__ = [
    "AHEAD",
    "LAWS",
    "PASSIVE",
    "SHARP",
    "SMOOTH",
    "ControlModel",
    "FrictionCompensation",
    "Law",
    "LawReplay",
    "Limited",
    "MomentumObserver",
    "SensorNoise",
    "State",
    "StatefulLaw",
    "ToeClearance",
    "Tracking",
    "compare_laws",
    "computed_torque",
    "default_gains",
    "feedforward_pd",
    "gravity_friction_pd",
    "gravity_support",
    "impedance",
    "lqr",
    "mean_pose",
    "pd",
    "replay_law",
    "self_tuning",
    "sensitivity_amplification",
    "simulate_law",
    "simulate_many",
    "stance",
    "standard_laws",
    "stateful",
    "toe_clearance",
]
