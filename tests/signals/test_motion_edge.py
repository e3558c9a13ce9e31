"""What the ends of a record do to velocity and acceleration: the bound that `motion_edge` states."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from exoid.signals import motion_edge
from exoid.signals.differentiation import difference, smooth_motion
from exoid.signals.filters.low_pass import edge_length

RATES = (4.0, 5.0, 6.0, 10.0, 31.25, 100.0)
"""Rates over the cut-off."""
BOUND = {1 / 8: 1e-5, 1 / 4: 2e-4, 1 / 2: 1e-2}
"""Frequency over the cut-off, and the part of its acceleration that may be wrong."""


def error_of_acceleration(rate, cutoff, frequencies):
    """Error that the ends cause at each sample of the first half, over the amplitude, (N/2,)."""
    samples = max(60, round(16 * rate / cutoff))
    angles = 2.0 * np.pi * np.outer(np.arange(samples) / rate, frequencies)
    waves = np.hstack([np.cos(angles), np.sin(angles)])
    found = difference(smooth_motion(waves, rate, cutoff), rate, 2, 4)
    real, imaginary = np.hsplit(found, 2)
    wave = np.exp(1j * angles)
    gain = (real + 1j * imaginary)[samples // 2] / wave[samples // 2]
    error = np.hypot(real - (gain * wave).real, imaginary - (gain * wave).imag) / (2.0 * np.pi * frequencies) ** 2
    return error.max(axis=1)[: samples // 2]


@pytest.mark.parametrize("rate", RATES)
def test_the_end_of_a_record_spoils_no_more_of_the_acceleration_than_the_bound_says(rate):
    for share, bound in BOUND.items():
        frequencies = np.linspace(0.01, share, 30) * 10.0
        error = error_of_acceleration(10.0 * rate, 10.0, frequencies)
        assert error[motion_edge(10.0 * rate, 10.0) :].max() < bound


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.5, 2.5), st.floats(1.0, 8.0), st.sampled_from([100.0, 250.0, 1000.0]))
def test_random_motions_that_begin_anywhere_keep_the_bound(seed, seconds, cutoff, rate):
    """Six harmonics below half of the cut-off, as sums of sines: errors are at most the bound times all amplitudes."""
    rng = np.random.default_rng(seed)
    kinematics_cutoff = 2.0 * cutoff
    frequencies = rng.uniform(0.02, 0.25, 6) * kinematics_cutoff
    amplitude, phase = rng.uniform(0.0, 1.0, 6), rng.uniform(0.0, 2.0 * np.pi, 6)
    edge = motion_edge(rate, kinematics_cutoff)
    t = np.arange(max(round(seconds * rate), 4 * edge)) / rate

    def motion(time):
        return np.sin(2.0 * np.pi * np.outer(time, frequencies) + phase) @ amplitude

    beyond = edge_length(rate, kinematics_cutoff, tolerance=1e-12)
    longer = np.arange(-beyond, len(t) + beyond) / rate
    inside = slice(beyond, beyond + len(t))
    full = difference(smooth_motion(motion(longer)[:, None], rate, kinematics_cutoff), rate, 2, 4)[inside]
    found = difference(smooth_motion(motion(t)[:, None], rate, kinematics_cutoff), rate, 2, 4)
    size = float(amplitude @ (2.0 * np.pi * frequencies) ** 2)
    assert np.abs(found - full)[edge:-edge].max() < 2.0 * BOUND[1 / 4] * size  # both ends at once


def test_polynomials_of_degree_seven_are_smoothed_without_any_error():
    t = np.linspace(-1.0, 1.0, 400)
    powers = np.stack([t**k for k in range(8)], axis=1)
    np.testing.assert_allclose(smooth_motion(powers, 200.0, 10.0), powers, atol=1e-9)
