"""Uneven stamps: how they are recognised, resampled, and refused."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from exoid import ExoidError
from exoid.signals import Recording

OMEGA = 2.0 * np.pi * np.array([0.5, 1.3])


def jittered(rate=100.0, samples=800, jitter=0.3, seed=0, start=0.0):
    """Stamps whose every one is off by up to ± jitter/2 intervals."""
    offsets = np.random.default_rng(seed).uniform(-jitter / 2, jitter / 2, samples)
    return start + (np.arange(samples) + offsets) / rate


def motion(time):
    """Angle and velocity of two joints at any time."""
    phase = np.outer(time, OMEGA) + np.array([0.2, 1.0])
    return 0.5 * np.sin(phase), 0.5 * OMEGA * np.cos(phase)


def recorded(time):
    q, v = motion(time)
    return Recording(time=time, q=q, v=v, tau=20.0 * np.sign(v) + 5.0 * q, joint_names=("hip", "knee"))


@pytest.mark.parametrize(("jitter", "uniform"), [(0.0, True), (4e-4, True), (4e-3, False), (0.3, False)])
def test_stamps_count_as_even_up_to_a_thousandth_of_an_interval(jitter, uniform):
    assert recorded(jittered(jitter=jitter)).is_uniform is uniform


@given(seed=st.integers(0, 2**32 - 1), jitter=st.floats(0.01, 0.6), rate=st.floats(60.0, 1000.0))
@settings(max_examples=40, deadline=None)
def test_resampling_preserves_a_smooth_motion_to_a_bound(seed, jitter, rate):
    time = jittered(rate, 400, jitter, seed)
    even = recorded(time).resampled()
    q, v = motion(even.time)
    assert even.is_uniform
    assert time[0] == even.time[0]
    assert time[-1] - 2.0 / even.sample_rate < even.time[-1] <= time[-1]
    step = 2.0 / rate * OMEGA.max()
    assert np.abs(even.q - q).max() < 0.05 * step**4 + 1e-12
    assert np.abs(even.v - v).max() < 0.05 * OMEGA.max() * step**4 + 1e-12


def test_a_jump_of_friction_does_not_overshoot():
    even = recorded(jittered(jitter=0.5)).resampled()
    assert np.abs(even.tau).max() <= np.abs(recorded(jittered(jitter=0.5)).tau).max()


def test_acceleration_survives_resampling_which_a_monotone_curve_through_the_angles_would_spoil():
    even = recorded(jittered(rate=100.0, jitter=0.3)).resampled()
    exact = -(OMEGA**2) * motion(even.time)[0]
    error = np.diff(even.q, 2, axis=0) * even.sample_rate**2 - exact[1:-1]
    assert np.abs(error[5:-5]).max() < 0.02 * np.abs(exact).max()


def test_a_gap_is_refused_with_its_row_and_length_and_the_advice_to_split():
    time = np.arange(300) / 100.0
    time[120:] += 0.25
    with pytest.raises(ExoidError, match=r"^row 120: a gap of 0\.26 s .*limit 0\.1 s; 1 in all.*split the log there"):
        recorded(time).resampled()
