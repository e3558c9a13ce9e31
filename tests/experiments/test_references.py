"""References: exact in their derivatives, fitted to data, on any leg."""

import numpy as np
import pytest

import exoid
from exoid.experiments import Approach, Hold, cuhk, fit_harmonics, gait_for_leg, healthy_gait
from exoid.experiments.gait import COSINE_DEG, MEAN_DEG, SINE_DEG, fit_to_limits
from exoid.experiments.limits import refuse_motion_beyond_limits

GAIT = healthy_gait(1.0, 1.0)
START, GOAL = np.array([[0.0], [0.5]]), np.array([[0.3], [-0.5]])
MOTIONS = {
    **{"gait": healthy_gait(), "swing": cuhk.swing(0), "hold": Hold(np.ones((2, 3)))},
    **{"approach": Approach(START, GOAL, 2.0)},
}


@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
def test_velocity_and_acceleration_are_derivatives(motion):
    """By central differences, also after an approach has ended."""
    step = 1e-5
    for t in np.linspace(0.05, 3.0, 57):
        before, now, after = (motion.at(t + shift) for shift in (-step, 0.0, step))
        np.testing.assert_allclose((after.q - before.q) / (2 * step), now.v, atol=1e-6)
        np.testing.assert_allclose((after.v - before.v) / (2 * step), now.a, atol=1e-3)


def series(phase):
    """θ = a0 + Σ a_k cos 2πkp + b_k sin 2πkp, written out [deg]."""
    k = 2.0 * np.pi * np.arange(1, 7)
    return MEAN_DEG + COSINE_DEG @ np.cos(k * phase) + SINE_DEG @ np.sin(k * phase)


@pytest.mark.parametrize("phase", [0.0, 0.13, 0.5, 0.999])
def test_the_healthy_gait_is_its_series(phase):
    np.testing.assert_allclose(np.rad2deg(GAIT.at(phase).q[:, 0]), series(phase), atol=1e-12)
    slow = healthy_gait(1.2, 10.0).at(10.0 * phase)
    np.testing.assert_allclose(np.rad2deg(slow.q[:, 0]) - MEAN_DEG, 1.2 * (series(phase) - MEAN_DEG), atol=1e-12)


def test_a_fit_finds_the_series_that_made_the_samples():
    """At uneven times, out of order, over several periods."""
    rng = np.random.default_rng(0)
    time = rng.uniform(0.0, 5.0, 60)
    found = fit_harmonics(time, np.array([GAIT.at(t).q[:, 0] for t in time]), 1.0, 6)
    for t in rng.uniform(-1.0, 9.0, 10):
        for ours, true in zip(found.at(t), GAIT.at(t), strict=True):
            np.testing.assert_allclose(ours, true, rtol=1e-9, atol=1e-9)


def test_a_stride_bends_the_hip_forwards_and_the_knee_backwards_on_every_leg():
    """Seen in space: the ankle's place in the plane is the same on both built-in legs, whatever their axes."""
    for time in (0.0, 2.0, 6.5):
        flexion = healthy_gait(1.0, 10.0).at(time).q[:, 0]
        for name in ("bleex", "cuhk"):
            leg = exoid.load_leg(name)
            q = gait_for_leg(leg, healthy_gait(1.0, 10.0)).at(time).q[:, 0]
            shank = leg.forward_kinematics(q).rotation[0, 1] @ np.array([0.0, 0.0, -1.0])
            tilt = flexion[0] - flexion[1]
            np.testing.assert_allclose(shank[[0, 2]], [np.sin(tilt), -np.cos(tilt)], atol=1e-12)


@pytest.mark.parametrize("scale", [0.3, 3.0])
def test_a_gait_is_fitted_into_joint_limits_only_where_it_leaves_them(scale):
    leg = exoid.load_leg("cuhk")
    gait = gait_for_leg(leg, healthy_gait(scale))
    fitted = fit_to_limits(leg, gait)
    refuse_motion_beyond_limits(leg, fitted, 10.0)
    if scale < 1.0:
        np.testing.assert_array_equal(fitted.at(3.3).q, gait.at(3.3).q)
    else:
        with pytest.raises(exoid.errors.BadArgumentError, match=r"it goes from .* the joint from "):
            refuse_motion_beyond_limits(leg, gait, 10.0)
