"""Figures of plans show the motion, its limits, and the expected precision of each parameter."""

import numpy as np
import pytest
from matplotlib.figure import Figure

import exoid
from exoid.experiments.excitation import MotionLimits, assess, plan_excitation
from exoid.view import paper
from exoid.view.plans import plot_planned_motion, plot_precision

LEG = exoid.load_leg("cuhk")


@pytest.fixture(scope="module")
def plan():
    limits = MotionLimits.of(LEG, velocity=1.5)
    return plan_excitation(LEG, noise=0.3, duration=12.0, highest=0.5, starts=1, criterion="d", limits=limits)


def test_a_planned_motion_is_drawn_for_one_period_between_its_limits(plan):
    with paper():
        figure = Figure()
        axes = figure.subplots(3, 1)
        assert plot_planned_motion(axes, plan) is axes
        figure.canvas.draw()
    hip = axes[0].lines[0]
    assert hip.get_xdata()[-1] == pytest.approx(plan.motions[0].period)
    np.testing.assert_allclose(hip.get_ydata()[0], np.rad2deg(plan.recordings[0].q[0, 0]))
    limits = {line.get_ydata()[0] for line in axes[1].lines if line.get_linestyle() == ":"}
    assert limits == {-1.5, 1.5}
    assert [text.get_text() for text in axes[0].get_legend().get_texts()] == ["hip", "knee", "limits"]


def test_dots_are_at_the_precision_with_the_marker_of_their_class(plan):
    still = plan.recordings[0]
    held = exoid.Recording(still.time, still.q * [1.0, 0.0], joint_names=LEG.joint_names)
    precision = assess(LEG, held, noise=0.3).precision
    with paper():
        figure = Figure()
        ax = figure.subplots()
        assert plot_precision(ax, precision) is ax
        figure.canvas.draw()
    lines = {line.get_label(): line for line in ax.lines}
    rows = len(precision.names) - 1 - np.arange(len(precision.names))
    k = precision.names.index("c0_hip")
    well = dict(zip(lines[precision.identifiability[k]].get_ydata(), lines["well"].get_xdata(), strict=True))
    assert well[rows[k]] == pytest.approx(100.0 * precision.relative[k])
    assert np.isfinite(lines["not"].get_xdata()).all()
    assert rows[precision.names.index("c0_knee")] in lines["not"].get_ydata()
    assert {lines[grade].get_marker() for grade in ("well", "not")} == {"o", "x"}
    assert [text.get_text() for text in ax.get_legend().get_texts()][-3:] == ["not", "limit of well", "limit of weakly"]
    assert not ax.patches  # a bar has no length on a logarithmic scale
