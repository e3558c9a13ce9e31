"""Figures draw what they are given on the axes they are given, and show nothing by themselves."""

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure

from exoid.control import Tracking
from exoid.rig import Energy
from exoid.signals import Approaches, Poses, Recording
from exoid.view import (
    paper,
    plot_approaches,
    plot_friction,
    plot_inertial_torque,
    plot_law_torques,
    plot_peak_errors,
    plot_reference,
    plot_stiffness,
    plot_torques,
    plot_tracking_errors,
)
from exoid.view.style import COLUMN

NAMES = ("hip", "knee", "ankle")
TIME = np.linspace(0.0, 4.0, 50)
RNG = np.random.default_rng(0)
POSES = Poses(RNG.uniform(-0.6, 0.6, (9, 3)), RNG.uniform(-2.0, 2.0, (9, 3)), NAMES)


def drawn(plot, rows=1):
    """Draw on new axes and render."""
    with paper():
        figure = Figure(figsize=(COLUMN, 0.7 * COLUMN * rows))
        axes = figure.subplots(rows, 1)
        returned = plot(axes)
        figure.canvas.draw()
    assert returned is axes
    return figure, axes


def inside(figure, ax):
    """Whether the legend is within the figure and above the axes."""
    box, axes = ax.get_legend().get_window_extent(), ax.get_window_extent()
    return box.x1 <= figure.bbox.x1 + 1.0 and box.y1 <= figure.bbox.y1 + 1.0 and box.y0 >= axes.y1 - 1.0


PLOTS = {
    "approaches": lambda ax: plot_approaches(ax, Approaches(POSES, POSES), 2, "ankle"),
    "stiffness": lambda ax: plot_stiffness(
        ax, POSES, np.repeat([0, 1, 2], 3), np.array([-40.0, -10.0, 20.0]), 2, "ankle"
    ),
    "inertia": lambda ax: plot_inertial_torque(ax, TIME, np.sin(TIME), np.sin(TIME), "ankle"),
    "friction": lambda ax: plot_friction(ax, np.cos(TIME), np.sign(np.cos(TIME)), 0.2646, "ankle"),
    "reference": lambda ax: plot_reference(ax, TIME, np.column_stack([TIME, -TIME]), ("hip", "knee")),
}


@pytest.mark.parametrize("name", PLOTS)
def test_axes_have_units_and_the_legend_hides_no_data(name):
    figure, ax = drawn(PLOTS[name])
    assert "[" in ax.get_xlabel()
    assert "[" in ax.get_ylabel()
    assert inside(figure, ax)


def test_the_friction_figure_draws_the_fitted_step():
    _, ax = drawn(PLOTS["friction"])
    np.testing.assert_allclose(ax.lines[1].get_ydata(), [-0.2646, -0.2646, 0.2646, 0.2646])


def test_the_reference_is_drawn_in_degrees():
    _, ax = drawn(PLOTS["reference"])
    np.testing.assert_allclose(ax.lines[0].get_ydata(), np.rad2deg(TIME))


def test_torques_of_each_joint_have_axes_of_their_own():
    measured = np.column_stack([np.sin(TIME), np.cos(TIME), TIME])
    models = [("CAD", 1.2 * measured, "red"), ("identified", measured, "blue")]
    figure, axes = drawn(lambda axes: plot_torques(axes, TIME, measured, models, NAMES), rows=3)
    for joint, ax in enumerate(axes):
        np.testing.assert_array_equal(ax.lines[-1].get_ydata(), measured[:, joint])
        assert len(ax.lines) == 3
        assert NAMES[joint] in ax.get_ylabel()
    assert inside(figure, axes[0])


def test_the_style_lasts_no_longer_than_its_block():
    before = mpl.rcParams["font.size"]
    with paper():
        assert mpl.rcParams["font.size"] == 8
    assert mpl.rcParams["font.size"] == before


def law_run(law, size):
    """A closed loop with errors of a given size [rad]."""
    error = size * np.column_stack([np.sin(TIME), np.cos(TIME)])
    log = Recording(TIME, error, joint_names=NAMES[:2])
    return Tracking(
        law, 100.0, NAMES[:2], TIME, 0.0 * error, error, error, 5.0 * error, log, Energy(*np.ones((4, 1))), 1.0
    )


RUNS = {"PD": law_run("pd", 0.2), "LQR": law_run("lqr", 0.002)}


@pytest.mark.parametrize("plot", [plot_tracking_errors, plot_law_torques])
def test_laws_are_drawn_over_the_counted_part_of_the_run(plot):
    figure, axes = drawn(lambda ax: plot(ax, RUNS, names=NAMES[:2], colours=("red", "blue")), rows=2)
    lines = [line for line in axes[1].get_lines() if len(line.get_xdata()) > 2]
    assert [line.get_color() for line in lines] == ["red", "blue"]
    late = TIME[TIME >= 1.0] - 1.0
    np.testing.assert_allclose(lines[0].get_xdata(), late)
    run = RUNS["PD"]
    drawn_y = np.rad2deg(run.error[:, 1]) if plot is plot_tracking_errors else run.tau[:, 1]
    np.testing.assert_allclose(lines[0].get_ydata(), drawn_y[TIME >= 1.0])
    assert inside(figure, axes[0])


def test_peak_errors_are_bars():
    figure, ax = drawn(lambda ax: plot_peak_errors(ax, RUNS, names=NAMES[:2]))
    widths = [patch.get_width() for patch in ax.patches]
    expected = [run.peak_deg[joint] for joint in (0, 1) for run in RUNS.values()]
    np.testing.assert_allclose(widths, expected)
    assert [label.get_text() for label in ax.get_yticklabels()] == ["PD", "LQR"]
    assert inside(figure, ax)
