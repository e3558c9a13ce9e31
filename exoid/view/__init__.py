"""Figures: functions of results that draw on matplotlib axes and return them."""

from .dynamics import plot_friction, plot_inertial_torque, plot_reference, plot_torques
from .plans import plot_planned_motion, plot_precision
from .statics import plot_approaches, plot_stiffness
from .style import paper

__all__ = [
    "paper",
    "plot_approaches",
    "plot_friction",
    "plot_inertial_torque",
    "plot_planned_motion",
    "plot_precision",
    "plot_reference",
    "plot_stiffness",
    "plot_torques",
]
