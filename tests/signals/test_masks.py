"""A recording of which only some samples count."""

import numpy as np

from exoid import Recording
from exoid.signals import Recordings

TIME = np.arange(200) / 100.0
SPANS = [(0.1, 0.3), (0.5, 0.505), (1.0, 1.4)]


def walk(**changes):
    q = 0.3 * np.sin(3.0 * TIME)[:, None] * [1.0, 0.5]
    return Recording(**{"time": TIME, "q": q, "tau": 2.0 * q, "joint_names": ("hip", "knee"), **changes})


def test_samples_from_start_to_before_stop_count_and_segments_of_segments_are_what_both_have_in_common():
    masked = walk().segments([(0.1, 0.3), (0.9, 1.4)]).segments([(0.0, 0.5), (1.0, 2.0)])
    np.testing.assert_array_equal(np.flatnonzero(masked.mask), [*range(10, 30), *range(100, 140)])
    assert masked.segment_times == ((0.1, 0.29), (1.0, 1.39))
    assert "60 in 2 segments" in repr(masked)


def test_a_sample_of_a_resampled_recording_counts_if_both_neighbours_did():
    rng = np.random.default_rng(0)
    uneven = walk(time=TIME + rng.uniform(-2e-3, 2e-3, 200)).segments([(0.5, 1.0)])
    inside = uneven.time[uneven.mask]
    even = uneven.resampled()
    counted = (even.time >= inside[0]) & (even.time <= inside[-1])
    np.testing.assert_array_equal(even.mask, counted)


def test_a_csv_log_keeps_the_mask_as_a_column(tmp_path):
    masked = walk().segments(SPANS)
    masked.to_csv(tmp_path / "log.csv")
    np.testing.assert_array_equal(Recording.from_csv(tmp_path / "log.csv", mask="mask").mask, masked.mask)
    assert Recording.from_csv(tmp_path / "log.csv").mask is None
    (read,) = Recordings.from_files([tmp_path / "log.csv"], mask="mask")
    np.testing.assert_array_equal(read.mask, masked.mask)
