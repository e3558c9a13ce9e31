"""Low-pass filters against closed forms and measured frequency responses."""

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import signal

from exoid import ExoidError
from exoid.signals import MovingAverage, zero_phase
from exoid.signals.filters.low_pass import design_frequency, edge_length, noise_bandwidth, slow_part


def response(frequency, rate, cutoff):
    """Complex gain of the filter at a frequency, measured on a sinusoid far from the ends."""
    edge = edge_length(rate, cutoff, tolerance=1e-12)
    samples = 2 * edge + int(40 * rate / frequency)
    time = np.arange(samples) / rate
    wave = np.exp(2j * np.pi * frequency * time)
    out = zero_phase(np.column_stack([wave.real, wave.imag]), rate, cutoff)
    middle = slice(edge, samples - edge)
    return np.mean((out[middle, 0] + 1j * out[middle, 1]) / wave[middle])


@given(rate=st.floats(20.0, 2000.0), share=st.floats(0.02, 0.45), frequency_share=st.floats(0.02, 0.48))
@settings(max_examples=40, deadline=None)
def test_every_frequency_passes_without_delay_and_with_the_documented_gain(rate, share, frequency_share):
    cutoff, frequency = share * rate, frequency_share * rate
    gain = response(frequency, rate, cutoff)
    ratio = np.tan(np.pi * frequency / rate) / np.tan(np.pi * cutoff / rate)
    expected = 1.0 / (1.0 + (np.sqrt(2.0) - 1.0) * ratio**8)
    assert abs(gain - expected) < 1e-8


def test_the_slow_part_is_that_of_a_filter_of_second_order_and_short_records_have_one():
    rate, cutoff, frequency = 100.0, 1.0, 3.0
    time = np.arange(6000) / rate
    wave = np.sin(2.0 * np.pi * frequency * time)[:, None]
    gain = np.ptp(slow_part(wave, rate, cutoff)[2000:4000]) / 2.0
    ratio = np.tan(np.pi * frequency / rate) / np.tan(np.pi * cutoff / rate)
    assert gain == pytest.approx(1.0 / (1.0 + (np.sqrt(2.0) - 1.0) * ratio**4), rel=1e-3)
    np.testing.assert_allclose(slow_part(np.full((9, 1), 3.0), rate, cutoff), 3.0, rtol=1e-9)


def test_a_record_that_is_too_short_is_told_how_long_it_must_be():
    with pytest.raises(ExoidError, match=r"^20 samples \(0\.2 s\) are too few for a cut-off of 1 Hz") as caught:
        zero_phase(np.ones((20, 1)), 100.0, 1.0)
    needed, seconds = re.search(r"more than (\d+) \((\S+) s\) are needed", str(caught.value)).groups()
    assert float(seconds) == pytest.approx(int(needed) / 100.0, rel=1e-3)
    np.testing.assert_allclose(zero_phase(np.ones((int(needed) + 1, 1)), 100.0, 1.0), 1.0)


def test_ends_are_continued_by_point_reflection():
    """Written out: each pass begins in the state in which the first sample, held for ever, leaves the filter."""
    x, pad = np.random.default_rng(2).normal(size=(500, 3)).cumsum(axis=0), edge_length(100.0, 8.0)
    sections = signal.butter(4, design_frequency(100.0, 8.0, 4), fs=100.0, output="sos")
    y = np.concatenate([2.0 * x[:1] - x[pad:0:-1], x, 2.0 * x[-1:] - x[-2 : -pad - 2 : -1]])
    for _ in range(2):
        state = signal.sosfilt_zi(sections)[:, :, np.newaxis] * y[0]
        y = signal.sosfilt(sections, y, axis=0, zi=state)[0][::-1]
    np.testing.assert_allclose(zero_phase(x, 100.0, 8.0), y[pad:-pad], rtol=0, atol=1e-13)


@pytest.mark.parametrize(("rate", "cutoff"), [(500.0, 8.0), (50.0, 8.0), (50.0, 20.0), (1000.0, 2.0), (100.0, 25.0)])
@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-5])
def test_beyond_the_edge_length_the_impulse_response_has_decayed_as_promised(rate, cutoff, tolerance):
    edge = edge_length(rate, cutoff, tolerance=tolerance)
    impulse = np.zeros(8 * edge + 4001)
    impulse[len(impulse) // 2] = 1.0
    tail = np.cumsum(zero_phase(impulse, rate, cutoff))[: len(impulse) // 2][::-1]
    assert 2.0 * np.abs(tail[edge:]).max() <= tolerance
    assert 2.0 * np.abs(tail[int(0.6 * edge) :]).max() > tolerance


@pytest.mark.parametrize(("rate", "cutoff"), [(500.0, 8.0), (50.0, 8.0), (50.0, 20.0), (100.0, 25.0)])
def test_the_noise_bandwidth_is_the_power_of_the_impulse_response(rate, cutoff):
    impulse = np.zeros(4001)
    impulse[2000] = 1.0
    power = np.sum(zero_phase(impulse, rate, cutoff) ** 2)
    assert noise_bandwidth(rate, cutoff) == pytest.approx(power, rel=1e-4)


@given(alpha=st.floats(0.01, 1.0), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=30, deadline=None)
def test_the_moving_average_is_its_recursion_started_at_the_first_sample(alpha, seed):
    x = np.random.default_rng(seed).normal(size=(30, 2, 3))
    expected = x.copy()
    for k in range(1, 30):
        expected[k] = alpha * x[k] + (1.0 - alpha) * expected[k - 1]
    np.testing.assert_allclose(MovingAverage(alpha).filter(x, 1.0), expected, atol=1e-12)
