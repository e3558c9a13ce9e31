# Table of contents of exoid.view: to add a name, import it here and list it. It is imported when it is first used.

from .coverage import plot_coverage, plot_excitation
from .dynamics import plot_friction, plot_inertial_torque, plot_reference, plot_torques
from .interaction import plot_gait_profile, plot_interaction
from .law_replay import plot_law_replay
from .parameters import plot_correlation, plot_parameters
from .plans import plot_planned_motion, plot_precision
from .residuals import plot_prediction, plot_residual_trend
from .scenes import Scene, SceneServer, scene
from .statics import plot_approaches, plot_stiffness
from .style import paper
from .tracking import plot_law_torques, plot_peak_errors, plot_tracking_errors

__all__ = [
    "Scene",
    "SceneServer",
    "paper",
    "plot_approaches",
    "plot_correlation",
    "plot_coverage",
    "plot_excitation",
    "plot_friction",
    "plot_gait_profile",
    "plot_inertial_torque",
    "plot_interaction",
    "plot_law_replay",
    "plot_law_torques",
    "plot_parameters",
    "plot_peak_errors",
    "plot_planned_motion",
    "plot_precision",
    "plot_prediction",
    "plot_reference",
    "plot_residual_trend",
    "plot_stiffness",
    "plot_torques",
    "plot_tracking_errors",
    "scene",
]
