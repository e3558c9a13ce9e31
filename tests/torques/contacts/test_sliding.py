"""Slips that all feet make alike, which only the motion of the base shows."""

from dataclasses import replace

import numpy as np
import pytest
from standing import mirrored, standing, with_imu

import exoid
from exoid.signals.link_wrenches import link_placements
from exoid.torques.contacts import level_rotation, split
from exoid.torques.contacts.imu import imu_errors
from exoid.torques.contacts.standing_base import standing_reading

FEET = ("left_foot", "right_foot")
FORCE, ENCODER = 0.05, 1e-4
RATE = 250.0


@pytest.fixture(scope="module")
def still(exo):
    """Squats on both feet with an IMU that has a bias."""
    return with_imu(standing(exo, "both", seed=5, noise=0.4, encoder=ENCODER, rate=RATE), 7)


def slipping(exo, log, speed, lasting=0.25, starts=(3.0, 7.0, 12.0, 16.0)):
    """Let both feet slip forward: the velocity is half a wave of the cosine. Tell when, and give the log."""
    forward = np.zeros((len(log), 3))
    slips = np.zeros(len(log), dtype=bool)
    for start in starts:
        phase = (log.time - start) / lasting
        inside = (phase >= 0.0) & (phase < 1.0)
        forward[inside, 0] = speed * np.pi / lasting * np.sin(2.0 * np.pi * phase[inside])  # of v sin²(π t / T)
        slips |= inside
    return replace(log, base=accelerated(exo, log, forward)), slips


def accelerated(exo, log, forward):
    """Add an acceleration in the laboratory to what the IMU reads."""
    rotation = link_placements(exo, log.q, "left_foot").rotation
    turn = level_rotation(exo, "left_foot") @ np.swapaxes(rotation, 1, 2)  # laboratory from base
    aside = np.einsum("nji,nj->ni", turn, forward)
    return replace(log.base, specific_force=log.base.specific_force + aside)


def test_a_slip_of_both_feet_is_seen_and_counted(exo, still):
    log, slips = slipping(exo, still, 0.025)
    parts = split(exo, log)
    assert 0.6 * slips.mean() < parts.left.moving < 1.2 * slips.mean()
    assert parts.left.slipping == 0.0
    assert 0.004 < parts.visible < 0.012


def test_a_slip_says_nothing_of_the_errors_of_the_imu(exo, still):
    phase = np.mod(still.time - 1.0, 2.0)
    forward = np.zeros((len(still), 3))
    forward[:, 0] = np.select([phase < 0.1, phase < 0.7], [0.9, -0.15], 0.0)  # starts in a jerk, and slows down
    ice = split(exo, replace(still, base=accelerated(exo, still, forward))).imu
    dry = split(exo, still).imu
    np.testing.assert_allclose(ice.std[3:6], dry.std[3:6], rtol=0.5)  # 18 times as large if slips counted as rest
    assert (np.abs(ice.force_bias - dry.force_bias) < 4.0 * dry.std[3:6]).all()  # 7 times then


def test_only_the_ends_of_a_rest_say_nothing_of_the_errors_of_the_imu(exo, still):
    """A foot that leans for 50 ms at both ends of each rest of 0.3 s."""
    phase = np.mod(still.time, 0.6)
    rests = {"left_foot": (phase < 0.3) & (still.time < 12.0)}
    ends = 0.04 * ((phase < 0.05) | ((phase > 0.25) & (phase < 0.3)))
    lean = replace(
        still.base,
        angular_velocity=still.base.angular_velocity + ends[:, np.newaxis] * (0.0, 1.0, 0.0),
        specific_force=still.base.specific_force + ends[:, np.newaxis] * (3.0, 0.0, 0.0),
    )
    at_rest = {"left_foot": standing_reading(exo, still, "left_foot", still.base.position)}
    level, leaning = (imu_errors(base, at_rest, rests, RATE) for base in (still.base, lean))
    assert abs(level.gyro_bias[1] - 0.01) < 3.0 * level.std[1]
    np.testing.assert_allclose(leaning.gyro_bias, level.gyro_bias, atol=2e-4)
    np.testing.assert_allclose(leaning.force_bias, level.force_bias, atol=2e-3)


def test_short_rests_do_not_make_a_foot_rock(exo, still):
    """Three rests of 0.3 s beside one of 10 s: a soft sole that still swings leans by 12 mrad in them."""
    short = (still.time > 10.5) & (np.mod(still.time, 0.5) < 0.3) & (still.time < 12.0)
    rests = {"left_foot": short | (still.time < 10.0)}
    force = still.base.specific_force + 0.12 * short[:, np.newaxis] * (1.0, 0.0, 0.0)
    at_rest = {"left_foot": standing_reading(exo, still, "left_foot", still.base.position)}
    found = imu_errors(replace(still.base, specific_force=force), at_rest, rests, RATE)
    level = imu_errors(still.base, at_rest, rests, RATE)
    assert not found.rocks
    np.testing.assert_allclose(found.force_bias, level.force_bias, atol=0.01)


def test_feet_that_rest_and_slips_below_the_noise_are_not_said_to_slip(exo, still):
    assert split(exo, still).left.moving < 0.001
    log, _ = slipping(exo, still, 0.002)
    assert split(exo, log).left.moving < 0.001


def test_the_slowest_slip_that_is_seen_follows_from_the_noise_of_imu_and_angles(exo, still):
    """Velocity noise between the window of the median and the low-pass, by the formula of docs/ground.md."""
    high, low = 10.0, 1.0 / 0.8
    accelerometer = 2.0 * FORCE**2 / RATE * (1.0 / low - 1.0 / high) / (2.0 * np.pi) ** 2
    jacobian = exo.contact_jacobian(still.q, "left_foot")
    lever = np.linalg.solve(jacobian[..., :3], jacobian[..., 3:])[:, 0]
    place = ENCODER**2 * np.mean(np.sum(lever**2, axis=1))
    angles = 2.0 * place / RATE * (2.0 * np.pi) ** 2 * (high**3 - low**3) / 3.0
    assert split(exo, still).visible == pytest.approx(6.0 * np.sqrt(accelerometer + angles), rel=0.5)


def test_without_an_imu_or_long_rests_nothing_is_looked_for(exo, still):
    log, _ = slipping(exo, still, 0.025)
    assert split(exo, replace(log, base=None)).visible == 0.0
    steps = (np.arange(len(log)) % 200) < 170  # rests of 0.68 s
    assert split(exo, replace(log, contacts=dict.fromkeys(FEET, steps))).visible == 0.0


@pytest.mark.nightly
def test_the_estimate_reports_slips_and_does_not_follow_them(exo, still):
    terms = (exoid.Viscous(),)
    left = standing(exo, "left", seed=6, noise=0.4, encoder=ENCODER, rate=RATE)
    slips, _ = slipping(exo, still, 0.025)
    found = exoid.identify(exo, [slips, left.recording, mirrored(left).recording], terms)
    (report,) = (finding for finding in found.findings if finding.kind == "slipping-contact")
    assert report.value > 0.02
    assert "mm/s" in report.message
