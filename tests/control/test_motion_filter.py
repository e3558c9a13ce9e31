"""The filter of angles, velocities and accelerations."""

import numpy as np
import pytest

from exoid.control.sensitivity_amplification import MotionFilter

FILTERS = pytest.mark.parametrize(("bandwidth", "rate"), [(5.0, 1000.0), (20.0, 500.0), (20.0, 100.0), (45.0, 100.0)])


def filtered(filter_, q, v):
    """All samples, {channel: (N, n)}."""
    memory, found = filter_.begin(q[0], v[0]), []
    for angle, speed in zip(q, v, strict=True):
        memory = filter_.step(memory, angle, speed)
        found.append(memory)
    return [np.array(x) for x in zip(*found, strict=True)]


@FILTERS
def test_constant_velocity_passes_without_transient(bandwidth, rate):
    """Every channel late by the same delay, from the first sample on."""
    one, time = MotionFilter(bandwidth, rate), np.arange(200)[:, None] / rate
    q, angle_rate, v, a, *_ = filtered(one, 0.3 + 2.0 * time, np.full_like(time, 2.0))
    np.testing.assert_allclose(q, 0.3 + 2.0 * (time - one.delay), atol=1e-12)
    np.testing.assert_allclose(angle_rate, 2.0, rtol=1e-12)
    np.testing.assert_allclose(v, 2.0, rtol=1e-12)
    np.testing.assert_allclose(a, 0.0, atol=1e-9)


@FILTERS
def test_constant_acceleration_is_found_and_the_velocity_is_late_by_the_same_time(bandwidth, rate):
    one, time = MotionFilter(bandwidth, rate), np.arange(int(2.0 * rate))[:, None] / rate
    _, _, v, a, *_ = filtered(one, 1.5 * time**2, 3.0 * time)
    np.testing.assert_allclose(a[-10:], 3.0, rtol=1e-9)
    np.testing.assert_allclose(v[-10:], 3.0 * (time[-10:] - one.delay), rtol=1e-9)


@pytest.mark.slow
@FILTERS
def test_no_frequency_is_amplified(bandwidth, rate):
    """Neither from readings to filtered readings, nor from the mean acceleration of a period to the filtered one."""
    one, count = MotionFilter(bandwidth, rate), 1 << 14
    pulse = np.zeros((count, 1))
    pulse[1] = 1.0
    _, _, v, a, *_ = filtered(one, pulse, pulse)
    frequency = np.fft.rfftfreq(count, 1.0 / rate)
    difference = np.abs(1.0 - np.exp(-2j * np.pi * frequency / rate))[1:] * rate
    assert np.abs(np.fft.rfft(v[:, 0])).max() <= 1.0 + 1e-9
    assert (np.abs(np.fft.rfft(a[:, 0]))[1:] / difference).max() <= 1.0 + 1e-9


def test_half_the_power_passes_at_the_bandwidth():
    one, count, rate = MotionFilter(20.0, 2000.0), 1 << 12, 2000.0
    pulse = np.zeros((count, 1))
    pulse[1] = 1.0
    gain = np.abs(np.fft.rfft(filtered(one, pulse, pulse)[2][:, 0]))
    assert np.interp(20.0, np.fft.rfftfreq(count, 1.0 / rate), gain**2) == pytest.approx(0.5, rel=0.01)
