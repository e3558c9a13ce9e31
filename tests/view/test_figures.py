"""Figures draw what they are given on the axes they are given, and show nothing by themselves."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from exoid.control import Tracking
from exoid.signals import Approaches, Poses, Recording
from exoid.torques.position_units import SLIDES, TURNS
from exoid.view import paper, plot_correlation, plot_law_torques, plot_tracking_errors
from exoid.view.experiments import plot_approaches, plot_reference, plot_stiffness
from exoid.view.fit import plot_friction_fit
from exoid.view.parameters import STRONG
from exoid.view.report.page import Picture, paper_figure
from exoid.view.style import COLUMN, PAGE

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
        figure.draw_without_rendering()
    assert returned is axes
    return figure, axes


def inside(figure, ax):
    """Whether the legend is within the figure and above the axes."""
    box, axes = ax.get_legend().get_window_extent(), ax.get_window_extent()
    return box.x1 <= figure.bbox.x1 + 1.0 and box.y1 <= figure.bbox.y1 + 1.0 and box.y0 >= axes.y1 - 1.0


FRICTION = 0.2646 * np.sign(TIME - 2.0)

PLOTS = {
    "approaches": lambda ax: plot_approaches(ax, Approaches(POSES, POSES), 2, "ankle"),
    "stiffness": lambda ax: plot_stiffness(
        ax, POSES, np.repeat([0, 1, 2], 3), np.array([-40.0, -10.0, 20.0]), 2, "ankle"
    ),
    "friction": lambda ax: plot_friction_fit(ax, TIME - 2.0, 1.1 * FRICTION, FRICTION, "ankle"),
    "reference": lambda ax: plot_reference(ax, TIME, np.column_stack([TIME, -TIME]), ("hip", "knee")),
}


@pytest.mark.parametrize("name", PLOTS)
def test_axes_have_units_and_the_legend_hides_no_data(name):
    figure, ax = drawn(PLOTS[name])
    assert "[" in ax.get_xlabel()
    assert "[" in ax.get_ylabel()
    assert inside(figure, ax)


def test_the_correlation_is_drawn_of_the_pairs_that_are_hard_to_separate(estimate):
    _, ax = drawn(lambda ax: plot_correlation(ax, estimate))
    strong = estimate.correlation[np.triu_indices(len(estimate.names), 1)]
    strong = sorted(strong[np.abs(strong) >= STRONG], key=abs, reverse=True)
    np.testing.assert_array_equal(ax.lines[0].get_xdata(), strong)
    first, second = ax.get_yticklabels()[0].get_text().split(" – ")
    assert estimate.correlation[estimate.names.index(first), estimate.names.index(second)] == strong[0]


@pytest.mark.parametrize(
    ("heights", "most", "width", "height", "across"),
    [
        ([2.0], 3, COLUMN, 2.0, 1),
        ([2.0, 2.0], 3, PAGE, 2.0, 2),
        ([2.0, 2.0, 2.0], 3, PAGE, 2.0, 3),
        ([2.0, 2.0, 2.0, 2.0], 3, PAGE, 4.0, 2),
        ([2.0] * 7, 3, PAGE, 6.0, 3),
        ([1.5, 3.0, 1.0, 2.0, 3.0], 2, PAGE, 6.0, 2),  # neighbours have like heights
    ],
)
def test_panels_of_a_figure_of_a_paper_fill_one_column_or_two(heights, most, width, height, across):
    def draw(part):
        part.add_subplot().plot([0.0, 1.0], label="line")
        part.axes[0].legend()

    figure = paper_figure([Picture(draw, "", height=each, across=most) for each in heights])
    figure.draw_without_rendering()
    np.testing.assert_allclose(figure.get_size_inches(), (width, height))
    assert len(figure.axes) == len(heights)
    boxes = [ax.get_window_extent() for ax in figure.axes]
    assert {int(across * box.x0 / figure.bbox.width) for box in boxes} == set(range(across))
    assert len({round(box.y0) for box in boxes}) == -(-len(heights) // across)
    assert [ax.get_legend() for ax in figure.axes].count(None) == (0 if len(heights) == 1 else len(heights))
    assert len(figure.legends) == (0 if len(heights) == 1 else 1), "one legend for all"


def law_run(law, size):
    """A closed loop with errors of a given size [rad]."""
    error = size * np.column_stack([np.sin(TIME), np.cos(TIME)])
    log = Recording(TIME, error, joint_names=NAMES[:2])
    return Tracking(law, 100.0, NAMES[:2], TIME, 0.0 * error, error, error, 5.0 * error, log, 1.0, units=UNITS)


UNITS = SLIDES, TURNS  # a slide, and a joint that turns
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
    assert axes[0].get_ylabel() == f"hip {'error [mm]' if plot is plot_tracking_errors else 'force [N]'}"
