"""Figures of plans show the motion, its limits, and the expected precision of each parameter."""

import numpy as np
import pytest
from matplotlib.figure import Figure

import exoid
from exoid.experiments.excitation import MotionLimits, assess, plan_excitation
from exoid.view import paper, plot_planned_motion, plot_precision
from exoid.view.plans import IDENTIFIABILITY_COLOURS

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
    assert [text.get_text() for text in axes[0].get_legend().get_texts()] == ["hip", "knee"]


def test_bars_end_where_parameters_are_known_and_are_coloured_by_identifiability(plan):
    still = plan.recordings[0]
    held = exoid.Recording(still.time, still.q * [1.0, 0.0], joint_names=LEG.joint_names)
    precision = assess(LEG, held, noise=0.3).precision
    with paper():
        figure = Figure()
        ax = figure.subplots()
        assert plot_precision(ax, precision) is ax
        figure.canvas.draw()
    bars = dict(zip(precision.names, ax.patches, strict=True))
    known = 100.0 * precision.relative[precision.names.index("c0_hip")]
    assert bars["c0_hip"].get_width() == pytest.approx(known)
    assert np.isfinite(bars["c0_knee"].get_width())
    assert [text.get_text() for text in ax.get_legend().get_texts()][-1] == "not"
    assert bars["c0_knee"].get_facecolor()[:3] == pytest.approx(
        tuple(int(IDENTIFIABILITY_COLOURS["not"][k : k + 2], 16) / 255 for k in (1, 3, 5))
    )
