"""The same calls identify arms of six and seven joints, whose base parameters are found numerically.

CI runs few replicates; ``EXOID_FULL_STUDIES=1 pytest -s -m '' tests/identification/test_any_robot.py`` runs a hundred
and prints coverage with its Monte-Carlo error.
"""

import dataclasses
import os

import numpy as np
import one_joint
import pytest
from arms import Arm
from swings import harmonics, holds
from unchecked import identify

import exoid
from exoid import ExoidError
from exoid.experiments.excitation import MotionLimits
from exoid.identification.selection import select_terms
from exoid.signals import ZeroPhase

REPLICATES = 100 if os.environ.get("EXOID_FULL_STUDIES") == "1" else 4
TRAIN, TEST = 1, 2
ROBOTS = ("panda", "ur5")
"""Franka Emika's arm of seven joints, Universal Robots' of six."""


@pytest.fixture(scope="module", params=ROBOTS)
def arm(request):
    return Arm(request.param)


def rms_behind_filter(noise, rate):
    """What no model can predict, (n,): the noise, filtered as both torques are."""
    filtered = ZeroPhase().filter(noise, rate)
    edge = ZeroPhase().edge(rate)
    return np.sqrt(np.mean(filtered[edge:-edge] ** 2, axis=0))


@pytest.mark.slow
def test_torque_of_a_motion_not_seen_is_predicted_to_the_noise(arm):
    noise = arm.noise_of(11)
    estimate = exoid.identify(arm.leg, arm.recording(TRAIN, arm.noise_of(10)))
    rmse = exoid.validate(estimate, arm.recording(TEST, noise)).rmse
    ratio = rmse / rms_behind_filter(noise, arm.rate)
    print(f"\n{arm.robot}: RMSE over noise floor {ratio.round(3)}, condition number {estimate.condition_number:.1f}")
    assert (ratio <= 1.1).all()
    assert set(estimate.names) <= set(arm.truth)
    assert estimate.condition_number < 100.0


def test_without_what_acts_beside_the_rigid_bodies_it_is_not(arm):
    estimate = identify(arm.leg, arm.recording(TRAIN, arm.noise_of(10)), terms=())
    noise = arm.noise_of(11)
    rmse = exoid.validate(estimate, arm.recording(TEST, noise)).rmse
    assert (rmse > 1.5 * rms_behind_filter(noise, arm.rate)).all()


def test_a_torque_of_wrong_sign_is_named_where_no_parameter_is_positive_by_nature(arm):
    log = arm.recording(TRAIN, arm.noise_of(10))
    signs = np.where(np.arange(len(arm.leg.joint_names)) == 1, -1.0, 1.0)
    found = exoid.check(arm.leg, dataclasses.replace(log, tau=signs * log.tau), ())
    assert arm.leg.joint_names[1] in [one.joint for one in found if one.kind == "torque-sign"]


def test_a_motion_that_excites_too_little_is_refused_with_the_parameters_concerned(arm):
    """All joints follow one sine: rank is missing."""
    time, q, _, _ = arm.motion(TRAIN)
    sine, v, a = harmonics(time, 0.2, 0.4 * np.pi, np.zeros((q.shape[1], 1)))
    wave = q.mean(axis=0) + sine
    tau = arm.torque(wave, v, a) + arm.noise_of(3)
    recording = exoid.Recording(time=time, q=wave, tau=tau, joint_names=arm.leg.joint_names)
    with pytest.raises(ExoidError, match="do not determine") as caught:
        identify(arm.leg, recording)
    assert any(name.split(" ")[0] in str(caught.value) for name in arm.leg.parameter_names)


@pytest.mark.nightly
@pytest.mark.parametrize("time_constant", [0.0, 0.05], ids=["white", "AR(1)"])
def test_intervals_hold_for_numeric_base_parameters_and_terms(arm, time_constant):
    """Nominal 95 %: 93 to 97 % of all intervals contain the truth, give or take the error of so few replicates."""
    inside, ratios = [], []
    floor = rms_behind_filter(noise := arm.noise_of(5000, time_constant), arm.rate)
    for seed in range(REPLICATES):
        estimate = identify(arm.leg, arm.recording(TRAIN, arm.noise_of(seed, time_constant)))
        truth = np.array([arm.truth[name] for name in estimate.names])
        inside.append(holds(estimate, truth))
        ratios.append(exoid.validate(estimate, arm.recording(TEST, noise)).rmse / floor)
    pooled, each = np.mean(inside), np.mean(inside, axis=0)
    measured = np.std(np.mean(inside, axis=1), ddof=1) / np.sqrt(REPLICATES)
    error = max(measured, np.sqrt(0.05 * 0.95 / (20 * REPLICATES)))  # as if 20 of each were independent
    joints = np.percentile(ratios, 95, axis=0).round(3)
    print(
        f"\n{arm.robot}, {len(each)} parameters, noise memory {time_constant} s, {REPLICATES} replicates: coverage "
        f"{pooled:.1%} ± {measured:.1%} (Monte Carlo), worst parameter {each.min():.0%}, RMSE over floor "
        f"{np.median(ratios):.3f} in the median, 95th percentile by joint {joints}, "
        f"{np.max(ratios):.3f} at most"
    )
    assert 0.93 - 3.0 * error <= pooled <= 0.97 + 3.0 * error
    if REPLICATES >= 100:
        assert 0.93 <= pooled <= 0.97
        assert time_constant or np.percentile(ratios, 95, axis=0).max() <= 1.1


def test_speeds_of_a_slide_are_small(tmp_path):
    """In rad/s the smoothing of dry friction is 15 mm/s, half of this motion, and 3° is 50 mm of its range."""
    path = tmp_path / "slide.urdf"
    path.write_text(one_joint.URDF.replace("revolute", "prismatic").replace("0 1 0", "1 0 0"), encoding="utf-8")
    leg, time = exoid.Leg.from_urdf(path), np.arange(4000) / 100.0
    q, v, _ = harmonics(time, np.array([0.015, 0.02 / 5.1]), np.array([2.0, 5.1]), np.zeros((1, 2)))
    tau = 14.0 * np.tanh(v / 5e-4) + 20.0 * v + np.random.default_rng(0).normal(0.0, 0.1, v.shape)
    log = exoid.Recording(time=time, q=q, tau=tau, joint_names=leg.joint_names)
    plain, by_hand = (exoid.identify(leg, log, terms) for terms in (None, (exoid.Coulomb(), exoid.Viscous())))
    chosen = select_terms(leg, log)
    for estimate, within in ((plain, 0.2), (by_hand, 0.7), (chosen.estimate, 0.1)):
        assert (estimate["c0_hip"].value, estimate["c0_hip"].unit) == (pytest.approx(14.0, abs=within), "N")
    assert not plain.findings
    assert " m/s" in chosen.joints[0].text
    assert np.isclose(MotionLimits.of(leg).upper, leg.limits.upper - 0.1 * np.deg2rad(3.0)).all()
