"""Figures of plans show the motion, its limits, and the expected precision of each parameter."""

import numpy as np
import pytest
from matplotlib.figure import Figure

import exoid
from exoid.experiments.excitation import MotionLimits, plan_excitation
from exoid.view import paper
from exoid.view.plans import plot_planned_motion

LEG = exoid.load_leg("cuhk")


@pytest.fixture(scope="module")
def plan():
    return planned(LEG)


def planned(leg, **angles):
    limits = MotionLimits.of(leg, velocity=1.5, angles_deg=angles)
    return plan_excitation(leg, noise=0.3, duration=12.0, highest=0.5, starts=1, criterion="d", limits=limits)


def test_positions_of_a_slide_are_drawn_in_mm_beside_angles():
    """Metres of a rail were drawn as if they were radians."""
    plan = planned(exoid.Leg.from_description(LEG.description, LEG.joint_names, base="z"), base_z=(-50.0, 50.0))
    axes = plot_planned_motion(Figure().subplots(3, 1), plan)
    slide, hip = (line.get_ydata()[1] for line in axes[0].lines[:2])
    q = plan.recordings[0].q[1]
    assert (slide, hip) == pytest.approx((1e3 * q[0], np.rad2deg(q[1])))
    assert axes[0].get_ylabel() == "position [mm]\nangle [deg]"


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
