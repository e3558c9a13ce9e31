"""From recordings to kinematics: accurate inside the valid rows, known to be bad outside."""

import dataclasses

import numpy as np
import pytest
from swings import harmonics

from exoid.signals import FiniteDifference, MovingAverage, Recording, ZeroPhase

FREQUENCIES = 2.0 * np.pi * np.array([0.3, 0.7, 1.3, 2.1])
AMPLITUDES = np.array([0.4, 0.2, 0.08, 0.04])
WAYS = [ZeroPhase(), ZeroPhase(5.0, 20.0), FiniteDifference(), MovingAverage(0.3)]


def truth(time):
    """Angle, velocity and acceleration of two joints; at t = 0 both are in the middle of a motion."""
    return harmonics(time, AMPLITUDES, FREQUENCIES, np.outer([0.4, 2.0], np.arange(1, 5)))


def recording(rate=200.0, seconds=12.0, **changes):
    time = 2.137 + np.arange(int(seconds * rate)) / rate
    q, v, _ = truth(time)
    return Recording(**{"time": time, "q": q, "tau": 10.0 * v, "joint_names": ("hip", "knee"), **changes})


def worst(found, exact):
    return np.abs(found - exact).max() / np.abs(exact).max()


@pytest.mark.parametrize("rate", [50.0, 200.0, 1000.0])
def test_velocity_and_acceleration_are_accurate_in_valid_rows_of_a_record_that_starts_mid_motion(rate):
    log = recording(rate)
    kinematics = ZeroPhase().kinematics(log)
    q, v, a = truth(log.time)
    rows = kinematics.valid
    assert worst(kinematics.q[rows], q[rows]) < 1e-8
    assert worst(kinematics.v[rows], v[rows]) < 5e-5
    assert worst(kinematics.a[rows], a[rows]) < 5e-5


def test_the_kinematics_cutoff_is_twice_the_cutoff_but_at_most_two_fifths_of_the_rate():
    assert ZeroPhase(8.0).kinematics_cutoff_at(200.0) == 16.0
    assert ZeroPhase(8.0).kinematics_cutoff_at(30.0) == 12.0
    assert ZeroPhase(8.0, 25.0).kinematics_cutoff_at(30.0) == 25.0


@pytest.mark.parametrize("way", WAYS, ids=lambda way: way.name)
def test_recorded_velocity_and_acceleration_are_used_and_the_rest_is_derived_from_the_angle(way):
    log = recording(200.0)
    _, v, a = truth(log.time)
    with_velocity = way.kinematics(dataclasses.replace(log, v=1.1 * v))
    with_both = way.kinematics(dataclasses.replace(log, v=1.1 * v, a=1.2 * a))
    bare = way.kinematics(log)
    rows = bare.valid
    np.testing.assert_allclose(with_velocity.v[rows], 1.1 * bare.v[rows], atol=0.01)
    np.testing.assert_allclose(with_velocity.a[rows], bare.a[rows], atol=1e-12)
    np.testing.assert_allclose(with_both.a[rows], 1.2 * bare.a[rows], atol=0.1)


@pytest.mark.parametrize("way", WAYS, ids=lambda way: way.name)
def test_an_uneven_recording_is_resampled_first(way):
    rng = np.random.default_rng(5)
    time = 2.0 + (np.arange(2400) + rng.uniform(-0.2, 0.2, 2400)) / 200.0
    q, v, _ = truth(time)
    uneven = Recording(time=time, q=q, tau=v, joint_names=("hip", "knee"))
    even = uneven.resampled()
    kinematics = way.kinematics(uneven)
    for found, expected in zip(kinematics[:3], way.kinematics(even)[:3], strict=True):
        np.testing.assert_array_equal(found, expected)
    assert len(kinematics.q) == len(even)


@pytest.mark.parametrize("way", WAYS, ids=lambda way: way.name)
def test_the_share_of_independent_samples_is_the_noise_power_left_by_the_filter(way):
    noise = np.random.default_rng(11).normal(size=(200_000, 1))
    assert np.var(way.filter(noise, 100.0)) == pytest.approx(way.independent_fraction(100.0), rel=0.05)


def test_finite_differences_filter_nothing_and_drop_the_first_and_last_sample():
    log, way = recording(100.0), FiniteDifference()
    kinematics = way.kinematics(log)
    assert kinematics.valid == slice(1, len(log) - 1)
    np.testing.assert_array_equal(kinematics.q, log.q)
    np.testing.assert_allclose(kinematics.v[1:-1], (log.q[2:] - log.q[:-2]) * 50.0, atol=1e-9)
    np.testing.assert_allclose(kinematics.a[1:-1], np.diff(log.q, 2, axis=0) * 1e4, atol=1e-8)
    assert way.filter(log.tau, 100.0) is log.tau
    assert way.parallel(100.0) is None


def test_the_moving_average_delays_every_signal_alike_and_smooths_columns_only_once():
    log, way = recording(200.0), MovingAverage(0.25)
    v = truth(log.time)[1]
    kinematics = way.kinematics(dataclasses.replace(log, v=v))
    np.testing.assert_array_equal(kinematics.q, MovingAverage(0.25).filter(log.q, 1.0))
    np.testing.assert_array_equal(kinematics.v, MovingAverage(0.25).filter(v, 1.0))
    np.testing.assert_array_equal(way.filter(log.tau, 200.0), MovingAverage(0.25).filter(log.tau, 1.0))
    assert way.parallel(200.0) is None
    assert 0.75**kinematics.valid.start <= 1e-3 < 0.75 ** (kinematics.valid.start - 1)
