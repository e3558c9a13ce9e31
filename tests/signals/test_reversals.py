"""Pulses at reversals are taken out of filtered rows; rests and shaking joints keep theirs."""

import numpy as np
import pytest

from exoid.signals import ParallelFilter
from exoid.signals.filters.reversals import reversal_pulses
from exoid.signals.filters.reversals import without_reversals as without_reversals_of_joints

FILTER = ParallelFilter(500.0, 8.0)
SAMPLES = 10_000
ROWS = range(500, SAMPLES - 500, FILTER.stride)


def without_reversals(signals, pulses, rows, parallel):
    """For one joint."""
    return without_reversals_of_joints([signals], [pulses], rows, parallel)[0]


def reversals(*spans):
    """Mask of one joint that is true over spans of samples."""
    mask = np.zeros(SAMPLES, dtype=bool)
    for start, end in spans:
        mask[start:end] = True
    return mask


def test_any_torque_at_a_reversal_vanishes():
    """As well as pulses a quarter of the period apart describe it, also across the cuts between pieces."""
    unknown = reversals((1000, 1040), (3000, 3100), (5300, 5330))
    signal = np.where(unknown, np.random.default_rng(0).normal(1.0, 1.0, SAMPLES), 0.0)[None]
    filtered = FILTER.among_zeros(signal, ROWS)
    left, *_ = without_reversals(filtered, reversal_pulses(unknown, FILTER), ROWS, FILTER)
    assert np.linalg.norm(left) < 0.02 * np.linalg.norm(filtered)


def test_pulses_lie_from_end_to_end_of_each_reversal_a_quarter_of_the_period_apart():
    spans = ((1000, 1040), (3000, 3100), (5300, 5301))
    found = reversal_pulses(reversals(*spans), FILTER)
    for start, end in spans:
        inside = found[(found >= start - 50) & (found < end + 50)]
        assert (inside[0], inside[-1]) == (start, end - 1)
        assert np.diff(inside, append=end).max() <= FILTER.rate / (4.0 * FILTER.cutoff) + 1.0


def test_rows_far_from_reversals_stay():
    unknown = reversals((5000, 5040))
    signal = FILTER.among_zeros(np.random.default_rng(1).normal(size=(2, SAMPLES)), ROWS)
    left, *_ = without_reversals(signal, reversal_pulses(unknown, FILTER), ROWS, FILTER)
    far = np.abs(np.array(ROWS) - 5020) > 500
    np.testing.assert_allclose(left[:, far], signal[:, far], atol=0.02)
    assert np.abs(left - signal).max() > 0.1


@pytest.mark.parametrize("step", range(1, FILTER.stride + 1))
def test_the_share_of_noise_that_is_left_is_that_of_filtered_white_noise_at_every_spacing_of_the_rows(step):
    unknown = reversals(*((start, start + 30) for start in range(600, SAMPLES, 400)))
    rows = range(ROWS.start, ROWS.stop, step)
    noise = FILTER.among_zeros(np.random.default_rng(5).normal(size=(50, SAMPLES)), rows)
    left, taken, share = without_reversals(noise, reversal_pulses(unknown, FILTER), rows, FILTER)
    assert share < 0.9
    np.testing.assert_allclose((left**2).sum() + (taken**2).sum(), (noise**2).sum(), rtol=1e-12)
    assert (left**2).sum() == pytest.approx(share * (noise**2).sum(), rel=0.02)


@pytest.mark.parametrize(("every", "kept"), [(50, True), (400, False)])
def test_a_joint_that_shakes_keeps_its_rows(every, kept):
    """Where reversals are so dense that nothing would be left."""
    unknown = reversals(*((start, start + 20) for start in range(0, SAMPLES, every)))
    signal = FILTER.among_zeros(np.random.default_rng(4).normal(size=(1, SAMPLES)), ROWS)
    left, _, share = without_reversals(signal, reversal_pulses(unknown, FILTER), ROWS, FILTER)
    assert (left == signal).all() == (share == 1.0) == kept
