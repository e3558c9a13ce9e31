# Table of contents of exoid.view: to add a name, import it here and list it. It is imported when it is first used.

from . import report
from .fit import plot_prediction, plot_residual_trend
from .forces import plot_interaction
from .parameters import plot_comparison, plot_correlation, plot_parameters
from .scenes import Scene, scene
from .style import paper, write_figures
from .tracking import plot_law_torques, plot_peak_errors, plot_tracking_errors

__all__ = [
    "Scene",
    "paper",
    "plot_comparison",
    "plot_correlation",
    "plot_interaction",
    "plot_law_torques",
    "plot_parameters",
    "plot_peak_errors",
    "plot_prediction",
    "plot_residual_trend",
    "plot_tracking_errors",
    "report",
    "scene",
    "write_figures",
]
