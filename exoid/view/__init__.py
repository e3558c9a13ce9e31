"""Figures: functions of results that draw on matplotlib axes and return them."""

from .dynamics import plot_friction, plot_inertial_torque, plot_reference, plot_torques
from .statics import plot_approaches, plot_stiffness
from .style import paper
from .tracking import plot_law_torques, plot_peak_errors, plot_tracking_errors

__all__ = [
    "paper",
    "plot_approaches",
    "plot_friction",
    "plot_inertial_torque",
    "plot_law_torques",
    "plot_peak_errors",
    "plot_reference",
    "plot_stiffness",
    "plot_torques",
    "plot_tracking_errors",
]
