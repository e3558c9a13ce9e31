"""The parallel filter is the zero-phase filter, worked out at some rows only."""

import numpy as np
import pytest

from exoid.signals import ParallelFilter, zero_phase

SETTINGS = [(500.0, 8.0), (500.0, 3.0), (50.0, 8.0), (1000.0, 2.0), (40.0, 19.0), (100.0, 25.0), (100.0, 49.0)]


def signals(count: int = 3, samples: int = 20_011) -> np.ndarray:
    return np.random.default_rng(0).standard_normal((count, samples))


@pytest.mark.parametrize(("rate", "cutoff"), SETTINGS)
@pytest.mark.parametrize("step", [1, 2, 3, 7, 16])
def test_rows_far_from_the_ends_are_those_of_the_filter_that_runs_forwards_and_backwards(rate, cutoff, step):
    parallel, x = ParallelFilter(rate, cutoff), signals()
    whole = zero_phase(x.T, rate, cutoff).T
    for first, last in ((parallel.reach, 20_011 - parallel.reach), (9_000, 9_001), (9_000, 9_100)):
        found = parallel.among_zeros(x, range(first, last, step))
        np.testing.assert_allclose(found, whole[:, first:last:step], rtol=0, atol=1e-12)


def test_a_stretch_is_the_same_in_whatever_surroundings_beyond_the_reach():
    parallel, x = ParallelFilter(500.0, 8.0), signals()
    part = parallel.among_zeros(
        x[:, 4_000 - parallel.reach : 5_000 + parallel.reach], range(parallel.reach, parallel.reach + 1000)
    )
    np.testing.assert_allclose(part, parallel.among_zeros(x, range(4_000, 5_000)), rtol=0, atol=1e-13)
    short = parallel.reach // 3
    cut = parallel.among_zeros(x[:, 4_000 - short : 5_000 + short], range(short, short + 1000))
    assert np.abs(cut - parallel.among_zeros(x, range(4_000, 5_000))).max() > 1e-9, "less than the reach must show"


@pytest.mark.parametrize(("rate", "cutoff"), [(500.0, 8.0), (1000.0, 3.0)])
def test_sums_of_products_over_every_pace_th_row_are_those_over_all_rows(rate, cutoff):
    """Rows between are redundant, also for signals with jumps such as the sign of a velocity."""
    parallel, rng = ParallelFilter(rate, cutoff), np.random.default_rng(1)
    x = np.sign(np.cumsum(rng.standard_normal((4, 60_000)), axis=1))
    x[3] = rng.standard_normal(60_000)
    assert parallel.stride > 5
    rows = range(2_000, 2_000 + 56_000 // parallel.stride * parallel.stride)
    every = parallel.among_zeros(x, rows)
    few = parallel.among_zeros(x, rows[:: parallel.stride])
    scale = np.sqrt(np.multiply.outer(np.mean(every**2, axis=1), np.mean(every**2, axis=1)))
    np.testing.assert_allclose(few @ few.T / few.shape[1] / scale, every @ every.T / every.shape[1] / scale, atol=1e-3)
