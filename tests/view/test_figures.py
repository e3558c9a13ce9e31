"""Figures draw what they are given on the axes they are given, and show nothing by themselves."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure

import exoid
from exoid.control import LawReplay, Tracking
from exoid.rig import Energy
from exoid.signals import Approaches, Poses, Recording
from exoid.view import (
    paper,
    plot_comparison,
    plot_correlation,
    plot_law_torques,
    plot_parameters,
    plot_peak_errors,
    plot_prediction,
    plot_residual_trend,
    plot_tracking_errors,
)
from exoid.view.colours import MEASURED, PREDICTED, joint_colour
from exoid.view.experiments import (
    plot_approaches,
    plot_reference,
    plot_stiffness,
    plot_torques,
)
from exoid.view.fit import plot_friction_fit
from exoid.view.parameters import STRONG
from exoid.view.report.page import Picture, paper_figure
from exoid.view.style import COLUMN, PAGE
from exoid.view.tracking import plot_law_replay

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


def test_the_friction_figure_draws_the_fitted_step():
    _, ax = drawn(PLOTS["friction"])
    drawn_ = {line.get_color(): line.get_ydata() for line in ax.lines if len(line.get_ydata()) > 2}
    np.testing.assert_allclose(drawn_[PREDICTED], FRICTION)
    np.testing.assert_allclose(drawn_[MEASURED], 1.1 * FRICTION)


def test_the_reference_is_drawn_in_degrees():
    _, ax = drawn(PLOTS["reference"])
    np.testing.assert_allclose(ax.lines[0].get_ydata(), np.rad2deg(TIME))


def test_torques_of_each_joint_have_separate_axes():
    measured = np.column_stack([np.sin(TIME), np.cos(TIME), TIME])
    models = [("CAD", 1.2 * measured, "red"), ("identified", measured, "blue")]
    figure, axes = drawn(lambda axes: plot_torques(axes, TIME, measured, models, NAMES), rows=3)
    for joint, ax in enumerate(axes):
        np.testing.assert_array_equal(ax.lines[-1].get_ydata(), measured[:, joint])
        assert len(ax.lines) == 3
        assert NAMES[joint] in ax.get_ylabel()
    assert inside(figure, axes[0])


def test_parameters_are_drawn_at_their_values_beside_cad(estimate):
    names = ["X1", "X2", "X3"]
    cad = dict(zip(estimate.names, 1.1 * estimate.values, strict=True))
    figure, ax = drawn(lambda ax: plot_parameters(ax, estimate, names, {"CAD": cad, "nothing": {}}))
    dots = {line.get_label(): line.get_xdata() for line in ax.lines}
    values = [estimate.value(name) for name in names]
    np.testing.assert_array_equal(ax.containers[0].lines[0].get_xdata(), values)
    np.testing.assert_allclose(dots["CAD"], 1.1 * np.array(values))
    ends = ax.containers[0].lines[2][0].get_segments()
    np.testing.assert_allclose(np.array(ends)[:, :, 0], estimate.interval()[[0, 3, 6]])
    assert [text.get_text() for text in ax.get_yticklabels()] == names
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


def test_a_comparison_draws_both_estimates_and_stars_what_differs(estimate, data):
    names, unit = ["X1", "Y1", "X2", "Y2", "X3", "Y3"], "kg·m"
    other = exoid.identify(data.leg, replace(data.test, tau=1.2 * data.test.tau))
    comparison = exoid.compare(estimate, other)
    figure, ax = drawn(lambda ax: plot_comparison(ax, estimate, other, comparison, unit))
    for container, one in zip(ax.containers, (estimate, other), strict=True):
        np.testing.assert_array_equal(container.lines[0].get_xdata(), [one.value(name) for name in names])
    texts = [text.get_text() for text in ax.texts if " ± " in text.get_text()]
    assert texts[-1] == "difference ± std"
    rows = [comparison.names.index(name) for name in names]
    assert [text.endswith("*") for text in texts[:-1]] == (comparison.adjusted[rows] < 0.05).tolist()
    assert texts[0].startswith(f"{comparison.difference[0]:.1f}"[:3].replace("-", "−"))
    assert any(text.endswith("*") for text in texts)
    assert inside(figure, ax)


def test_a_prediction_has_its_residual_and_band():
    measured, predicted = np.sin(TIME), np.sin(TIME) + 0.1
    band = np.column_stack([predicted - 0.2, predicted + 0.2])
    figure, ax = drawn(lambda ax: plot_prediction(ax, TIME, measured, predicted, "knee", band))
    lines = {line.get_label(): line.get_ydata() for line in ax.lines}
    np.testing.assert_allclose(lines["residual"], -0.1)
    edge = ax.collections[0].get_paths()[0].vertices[:, 1]
    np.testing.assert_allclose([edge.min(), edge.max()], [band.min(), band.max()])
    assert inside(figure, ax)


def test_the_mean_residual_shows_what_the_dots_hide():
    rng = np.random.default_rng(1)
    velocity = rng.uniform(-1.0, 1.0, 20_000)
    residual = 0.3 * velocity + rng.normal(0.0, 1.0, len(velocity))
    _, ax = drawn(lambda ax: plot_residual_trend(ax, velocity, residual, 0, "velocity [rad/s]", "hip"))
    centre, mean = ax.containers[0].lines[0].get_xydata().T
    np.testing.assert_allclose(mean, 0.3 * centre, atol=0.15)
    assert len(ax.lines[0].get_xdata()) <= 5000, "not every sample is drawn"


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


def test_peak_errors_are_dots_in_the_colours_of_the_joints():
    figure, ax = drawn(lambda ax: plot_peak_errors(ax, RUNS, names=NAMES[:2]))
    for joint, line in enumerate(ax.lines):
        np.testing.assert_allclose(line.get_xdata(), [run.peak_deg[joint] for run in RUNS.values()])
        assert line.get_color() == joint_colour(joint)
    assert [label.get_text() for label in ax.get_yticklabels()] == ["PD", "LQR"]
    assert not ax.patches  # a bar has no length on a logarithmic scale
    assert inside(figure, ax)


def test_a_law_replay_shows_both_torques_and_the_limits():
    time = np.arange(50) / 100.0
    known = np.column_stack([np.sin(time), np.full(50, np.nan)])
    commanded = np.column_stack([np.cos(time), np.cos(time)])
    replay = LawReplay("pd", 100.0, NAMES[:2], time, commanded, known, np.array([1.0, np.inf]), np.full(2, np.inf))
    _, axes = drawn(lambda axes: plot_law_replay(axes, replay), rows=2)
    assert [len(ax.get_lines()) for ax in axes] == [4, 1]
    assert axes[0].get_legend_handles_labels()[1] == ["recorded", "pd", "limit"]
