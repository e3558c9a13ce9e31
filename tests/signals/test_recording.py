"""A recording is checked when it is made and does not change afterwards; only some of its samples may count."""

import math

import numpy as np
import pytest

from exoid import ExoidError
from exoid.signals import Recording, Recordings, Source

JOINTS = ("hip", "left_knee")
TIME = np.arange(60) / 50.0


def arrays(**changes):
    """A small valid motion of two joints, with changes."""
    phase = np.column_stack([TIME, TIME + 0.3]) * 4.0
    made = {"q": 0.5 * np.sin(phase), "v": 2.0 * np.cos(phase), "a": -8.0 * np.sin(phase), "tau": 30.0 * np.cos(phase)}
    return {"time": TIME, **made, "joint_names": JOINTS, **changes}


def refused(match, **changes):
    with pytest.raises(ExoidError, match=match):
        Recording(**arrays(**changes))


def test_a_recording_tells_its_size_rate_and_duration():
    recording = Recording(**arrays())
    assert (len(recording), recording.n_joints) == (60, 2)
    assert recording.sample_rate == pytest.approx(50.0, rel=1e-12)
    assert recording.duration == pytest.approx(59 / 50)
    assert recording.is_uniform
    assert repr(recording) == "Recording(60 samples at 50 Hz, 1.18 s; joints: hip, left_knee; q, v, a, tau)"


def test_arrays_are_copies_that_cannot_be_written():
    given = arrays(q=np.asfortranarray(arrays()["q"]))
    recording = Recording(**given)
    given["q"][0, 0] = 1.0
    assert recording.q[0, 0] != 1.0
    for name in ("time", "q", "v", "a", "tau"):
        values = getattr(recording, name)
        assert values.dtype == np.float64
        assert values.flags.c_contiguous
        with pytest.raises(ValueError, match="read-only"):
            values[0] = 0.0


@pytest.mark.parametrize("noise", [0.0, 1e-3])
def test_velocity_in_degrees_beside_angles_in_radians_is_refused_noise_or_not(noise):
    rng = np.random.default_rng(0)
    q = arrays()["q"] + noise * rng.normal(size=(60, 2))
    v = arrays()["v"] + noise * rng.normal(size=(60, 2))
    refused(
        r"v of joint hip is 5\d\.\d times the rate of its q: v looks like degrees.*deg2rad\(v\)", q=q, v=np.rad2deg(v)
    )
    refused(r"v of joint hip is 0\.01\d+ times .*: q looks like degrees", q=10.0 * q, v=np.deg2rad(10.0 * v))


@pytest.mark.parametrize("factor", [0.002, 0.1, 0.5, 10.0, 40.0, 80.0, 500.0])
def test_a_velocity_that_is_wrong_by_another_factor_is_not_called_degrees(factor):
    assert Recording(**arrays(v=factor * arrays()["v"])).v is not None


def test_select_reorders_and_drops_joints_by_name():
    recording = Recording(**arrays(), source=Source("log.csv", "0" * 64))
    swapped = recording.select(["left_knee", "hip"])
    assert swapped.joint_names == ("left_knee", "hip")
    for name in ("q", "v", "a", "tau"):
        np.testing.assert_array_equal(getattr(swapped, name), getattr(recording, name)[:, ::-1])
    assert recording.select("hip").q.shape == (60, 1)
    assert swapped.source == recording.source


def test_slices_by_row_and_by_time_agree_and_share_no_row():
    recording = Recording(**arrays())
    early, late = recording.between(-math.inf, TIME[20]), recording.between(TIME[20], math.inf)
    np.testing.assert_array_equal(np.concatenate([early.tau, late.tau]), recording.tau)
    np.testing.assert_array_equal(late.q, recording.slice(20).q)
    np.testing.assert_array_equal(recording.slice(-10).time, TIME[-10:])


def test_samples_from_start_to_before_stop_count_and_segments_of_segments_are_what_both_have_in_common():
    masked = Recording(**arrays()).segments([(0.1, 0.3), (0.9, 1.1)]).segments([(0.0, 0.5), (1.0, 2.0)])
    np.testing.assert_array_equal(np.flatnonzero(masked.mask), [*range(5, 15), *range(50, 55)])
    assert masked.segment_times == ((0.1, 0.28), (1.0, 1.08))
    assert "15 in 2 segments" in repr(masked)


def test_a_sample_of_a_resampled_recording_counts_if_both_neighbours_did():
    rng = np.random.default_rng(0)
    uneven = Recording(**arrays(time=TIME + rng.uniform(-2e-3, 2e-3, 60))).segments([(0.5, 1.0)])
    inside = uneven.time[uneven.mask]
    even = uneven.resampled()
    counted = (even.time >= inside[0]) & (even.time <= inside[-1])
    np.testing.assert_array_equal(even.mask, counted)


def test_a_csv_log_keeps_the_mask_as_a_column(tmp_path):
    masked = Recording(**arrays()).segments([(0.1, 0.3), (0.5, 0.505), (0.8, 1.0)])
    masked.to_csv(tmp_path / "log.csv")
    np.testing.assert_array_equal(Recording.from_csv(tmp_path / "log.csv", mask="mask").mask, masked.mask)
    assert Recording.from_csv(tmp_path / "log.csv").mask is None
    (read,) = Recordings.from_files([tmp_path / "log.csv"], mask="mask")
    np.testing.assert_array_equal(read.mask, masked.mask)
