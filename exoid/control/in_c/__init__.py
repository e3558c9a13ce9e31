"""Control laws as C99: which template and which numbers each law is in C; :mod:`exoid.codegen.laws` writes them."""

from .admittance import admittance_in_c
from .assist_as_needed import assist_as_needed_in_c
from .computed_torque import computed_torque_in_c
from .feedforward_pd import feedforward_pd_in_c
from .forms import law_in_c, register_law_in_c
from .gravity_friction_pd import gravity_friction_pd_in_c
from .gravity_support import gravity_support_in_c
from .impedance import impedance_in_c
from .kalman_observer import kalman_observer_in_c
from .leg import leg_in_c
from .limited import limited_in_c
from .lqr import lqr_in_c
from .momentum_observer import momentum_observer_in_c
from .pd import pd_in_c
from .ros2 import write_ros2
from .sensitivity_amplification import sensitivity_amplification_in_c
from .write import c_source, write_c

__all__ = [
    "admittance_in_c",
    "assist_as_needed_in_c",
    "c_source",
    "computed_torque_in_c",
    "feedforward_pd_in_c",
    "gravity_friction_pd_in_c",
    "gravity_support_in_c",
    "impedance_in_c",
    "kalman_observer_in_c",
    "law_in_c",
    "leg_in_c",
    "limited_in_c",
    "lqr_in_c",
    "momentum_observer_in_c",
    "pd_in_c",
    "register_law_in_c",
    "sensitivity_amplification_in_c",
    "write_c",
    "write_ros2",
]
