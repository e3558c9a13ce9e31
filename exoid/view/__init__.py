"""Figures: functions of results that draw on matplotlib axes and return them."""

from .dynamics import plot_friction, plot_inertial_torque, plot_reference, plot_torques
from .stability import plot_gain_margins, plot_lyapunov, plot_regulation_errors
from .statics import plot_approaches, plot_stiffness
from .style import paper

__all__ = [
    "paper",
    "plot_approaches",
    "plot_friction",
    "plot_gain_margins",
    "plot_inertial_torque",
    "plot_lyapunov",
    "plot_reference",
    "plot_regulation_errors",
    "plot_stiffness",
    "plot_torques",
]
