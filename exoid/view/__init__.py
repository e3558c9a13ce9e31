"""Figures, functions of results that draw on matplotlib axes and return them, and the leg in three dimensions."""

from .dynamics import plot_friction, plot_inertial_torque, plot_reference, plot_torques
from .scenes import Scene, SceneServer, scene
from .statics import plot_approaches, plot_stiffness
from .style import paper

__all__ = [
    "Scene",
    "SceneServer",
    "paper",
    "plot_approaches",
    "plot_friction",
    "plot_inertial_torque",
    "plot_reference",
    "plot_stiffness",
    "plot_torques",
    "scene",
]
