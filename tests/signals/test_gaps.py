"""Gaps and repeated stamps: a log is split there, if asked for."""

import numpy as np
import pytest
from log_writers import named_columns, write_columns

import exoid
from exoid import Recording
from exoid.errors import UnreadableInputError


@pytest.fixture(scope="module")
def swing():
    return exoid.datasets.bleex_swing().train


def write(path, recording, rows, repeated=()):
    """Write some rows of a recording, and some twice."""
    order = np.sort(np.concatenate([np.flatnonzero(rows), np.asarray(repeated, dtype=int)]))
    return write_columns(path, **{name: values[order] for name, values in named_columns(recording).items()})


def test_a_log_with_gaps_and_repeated_stamps_gives_what_its_parts_give(tmp_path, swing):
    """Parameters agree with those of the three parts, and rows near a gap do not count."""
    time = swing.time - swing.time[0]
    present = (time < 5.0) | ((time > 5.8) & (time < 9.0)) | (time > 12.0)
    path = write(tmp_path / "log.csv", swing, present, repeated=(100, 101, 2500))
    log = Recording.from_file(path, gaps="split")
    assert log.is_uniform
    counted = log.time[log.mask] - swing.time[0]
    assert not ((counted > 4.5) & (counted < 6.3)).any()
    assert counted.min() < 0.1
    whole = exoid.identify(exoid.load_leg("bleex"), log)
    edges = ((0.0, 5.0), (5.8, 9.0), (12.0, time[-1]))
    parts = [swing.between(swing.time[0] + start, swing.time[0] + stop) for start, stop in edges]
    apart = exoid.identify(exoid.load_leg("bleex"), parts)
    assert whole.names == apart.names
    assert (np.abs(whole.values - apart.values) < 0.5 * apart.std).all()
    np.testing.assert_allclose(whole.std, apart.std, rtol=0.4)


def test_the_mask_and_the_contacts_of_a_log_are_carried_over(tmp_path):
    time = np.delete(np.arange(600) / 100.0, slice(200, 250))
    columns = {"time": time, "q_knee": np.sin(time), "tau_knee": time, "contact_foot": time > 2.0, "good": time < 4.0}
    log = Recording.from_file(write_columns(tmp_path / "log.csv", **columns), gaps="split", mask="good")
    assert len(log) == 600
    assert set(np.flatnonzero(log.mask)) == {*range(150), *range(300, 400)}
    assert log.contacts["foot"][log.time > 2.5].all()
    np.testing.assert_array_equal(log.q[log.mask, 0], np.sin(log.time[log.mask]))


def test_quaternions_whose_sign_changes_in_a_gap_are_one_motion(tmp_path):
    """Motion capture begins again with either sign; the log was refused for a norm of 0.04."""
    time = np.delete(np.arange(600) / 100.0, slice(200, 250))
    half, sign = 0.1 * np.sin(time), np.where(time > 2.2, -1.0, 1.0)
    columns = {"time": time, "q_knee": time}
    columns |= {f"base_{axis}": 0.0 * time for axis in ("x", "y", "z", "qx", "qy")}
    columns |= {"base_qz": sign * np.sin(half), "base_qw": sign * np.cos(half)}
    log = Recording.from_file(write_columns(tmp_path / "log.csv", **columns), gaps="split")
    np.testing.assert_allclose(log.base.pose.quaternion[:, 2], np.sin(0.1 * np.sin(log.time)), atol=1e-3)


def test_without_the_option_both_are_refused_and_what_is_no_log_is_refused_with_it(tmp_path, swing):
    time = swing.time - swing.time[0]
    for rows, repeated, what in ((abs(time - 5.0) > 0.5, (), "a gap of"), (time > -1.0, (7,), "time is repeated")):
        path = write(tmp_path / "log.csv", swing, rows, repeated)
        with pytest.raises(UnreadableInputError, match=what):
            Recording.from_file(path)
    far = exoid.Recording(np.where(time > 5.0, time + 1e4, time), swing.q, tau=swing.tau, joint_names=swing.joint_names)
    path = write(tmp_path / "far.csv", far, time > -1.0)
    with pytest.raises(UnreadableInputError, match="gaps of 1e"):
        Recording.from_file(path, gaps="split")


def test_the_command_line_splits_too(exoid_, tmp_path, swing):
    write(tmp_path / "log.csv", swing, abs(swing.time - swing.time[0] - 5.0) > 0.5, repeated=(50,))
    assert exoid_("check", "bleex", "log.csv").refusal
    assert exoid_("identify", "bleex", "log.csv", "--gaps", "split", "--json").printed
