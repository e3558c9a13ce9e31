"""Residuals against velocity and angle: silent under noise, also correlated, and outspoken where a term is missing."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter
from swings import TERMS, Swing
from unchecked import identify

import exoid
from exoid import Offset, Stiffness
from exoid.signals import FiniteDifference, ZeroPhase

PLAIN = FiniteDifference()


@pytest.fixture(scope="module")
def swing():
    return Swing(exoid.load_leg("bleex"), 100.0)


def coloured(swing, seed, std=0.5):
    noise = np.random.default_rng(seed).normal(size=swing.torque.shape)
    return std * lfilter([0.6], [1.0, -0.8], noise, axis=0)


@pytest.mark.nightly
@pytest.mark.parametrize("preparation", [PLAIN, ZeroPhase()], ids=lambda p: p.name)
@pytest.mark.parametrize("estimator", ["wls", "gls"])
@pytest.mark.parametrize("terms", [TERMS, (*TERMS, Offset())], ids=["", "offset"])
def test_noise_is_called_a_dependence_as_seldom_as_it_should(swing, estimator, preparation, terms):
    """Also where an offset has set the sum of all residuals to zero, of which decimated rows see only nearly all."""
    p_values = []
    for seed in range(12):
        recording = swing.recording(tau=swing.torque + coloured(swing, seed))
        estimate = identify(swing.leg, recording, terms, estimator, preparation=preparation)
        p_values += [trend.p_value for trend in estimate.trends]
    p_values = np.array(p_values)
    print(f"of {len(p_values)} below 5 %: {np.mean(p_values < 0.05):.3f}, below 50 %: {np.mean(p_values < 0.5):.3f}")
    assert np.mean(p_values < 0.05) < 0.15
    assert 0.35 < np.mean(p_values < 0.5) < 0.7
    assert p_values.min() > 1e-4


@pytest.mark.slow
def test_what_the_mean_is_believed_to_vary_by_is_what_it_varies_by(swing):
    """Over repetitions, the standard deviation given is that found, also though parameters were fitted."""
    means, stds = [], []
    for seed in range(40):
        recording = swing.recording(tau=swing.torque + coloured(swing, seed))
        trends = identify(swing.leg, recording, TERMS, preparation=PLAIN).trends
        means.append([trend.mean for trend in trends])
        stds.append([trend.std for trend in trends])
    ratio = np.std(means, axis=0) / np.mean(stds, axis=0)
    print(f"found over given: {ratio.mean():.3f}")
    assert ratio.mean() == pytest.approx(1.0, abs=0.07)


def test_friction_of_another_form_is_found_in_the_velocity(swing):
    v = swing.motion[1]
    stribeck = 0.5 * swing.coulomb * np.exp(-((v / 0.1) ** 2)) * np.tanh(v / 0.02) * [0.0, 0.0, 1.0]
    estimate = identify(swing.leg, swing.recording(tau=swing.torque + stribeck + coloured(swing, 0, 0.03)), TERMS)
    assert [(t.joint, t.against) for t in estimate.trends if t.matters] == [(swing.leg.joint_names[2], "velocity")]
    assert any("residual of left_ankle depends on its velocity" in warning for warning in estimate.warnings)


def test_a_spring_that_the_model_lacks_is_found_in_the_angle(swing):
    spring = 3.0 * swing.motion[0] ** 3 * [0.0, 1.0, 0.0]
    recording = swing.recording(tau=swing.torque + spring + coloured(swing, 0, 0.05))
    estimate = identify(swing.leg, recording, TERMS, preparation=PLAIN)
    assert ("left_knee", "angle") in [(t.joint, t.against) for t in estimate.trends if t.matters]
    mended = identify(swing.leg, recording, (*TERMS, Stiffness(degree=3, joints=("knee",))), preparation=PLAIN)
    assert not [t for t in mended.trends if t.matters]


def test_a_perfect_model_is_not_blamed_for_rounding(swing):
    for recording in (swing.recording(), swing.encoders_only()):
        estimate = identify(swing.leg, recording, (*TERMS, Offset()))
        assert not estimate.warnings
