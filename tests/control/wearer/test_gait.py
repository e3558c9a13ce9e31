"""The phase follows a cadence that changes, and the profile averages over it."""

import dataclasses

import numpy as np
import pytest

from exoid import Recording
from exoid.control.wearer.gait import find_phase, profile
from exoid.errors import BadArgumentError

RATE = 100.0


def walking(period=1.1, change=0.0, seconds=30.0):
    """Angles of a gait with harmonics, whose period changes by a share over the log; turns since the start."""
    time = np.arange(0.0, seconds, 1.0 / RATE)
    turns = time / period * (1.0 + 0.5 * change * (time / seconds - 0.5))
    at = 2.0 * np.pi * turns
    hip = 0.4 * np.cos(at) + 0.1 * np.cos(2.0 * at + 0.3)
    knee = 0.5 * np.cos(at + 1.0) - 0.3 * np.cos(2.0 * at)
    return Recording(time, np.column_stack([hip, knee]), joint_names=("hip", "knee")), turns


def inner(recording, margin=2.0):
    return (recording.time > recording.time[0] + margin) & (recording.time < recording.time[-1] - margin)


@pytest.mark.parametrize(("period", "change"), [(1.1, 0.0), (1.37, 0.0), (1.1, 0.1)])
def test_the_period_of_a_gait_is_found(period, change):
    recording, turns = walking(period, change)
    phase, mean, begins = find_phase(recording)
    used = inner(recording)
    difference = np.exp(2j * np.pi * (phase - turns))[used]
    constant = difference.mean() / np.abs(difference.mean())
    assert np.abs(np.angle(difference / constant)).max() < 2.0 * np.pi * 0.04
    assert mean == pytest.approx(recording.duration / (turns[-1] - turns[0]), rel=0.01)
    assert begins == "largest angle of knee"
    knee, near = recording.q[used, 1], np.minimum(phase, 1.0 - phase)[used] < 0.02
    assert change or knee[near].min() > knee.max() - 0.05


def test_motion_that_does_not_repeat_has_no_phase():
    rng = np.random.default_rng(1)
    time = np.arange(0.0, 30.0, 0.01)
    drift = np.cumsum(rng.standard_normal((len(time), 2)), axis=0) * 0.01
    assert np.isnan(find_phase(Recording(time, drift, joint_names=("a", "b")))[0]).all()
    assert find_phase(Recording(time, np.zeros((len(time), 1)), joint_names=("a",)))[1] is None


def test_touch_downs_begin_a_cycle():
    recording, turns = walking(1.25)
    contact = turns % 1.0 < 0.6
    phase, _, begins = find_phase(dataclasses.replace(recording, contacts={"foot": contact}))
    known = ~np.isnan(phase)
    assert begins == "touch-down of foot"
    error = np.exp(2j * np.pi * (phase - turns))[known]
    assert np.abs(np.angle(error)).max() < 2.0 * np.pi * 0.02
    assert not known[recording.time < 1.2].any()


@pytest.mark.parametrize("strides", [[1.0], [2.0, 1.0], [1.0, np.nan], [100.0, 101.0]])
def test_wrong_strides_are_refused(strides):
    with pytest.raises(BadArgumentError):
        find_phase(walking()[0], strides)


def test_the_profile_is_the_mean_over_each_part_of_the_cycle():
    phase = np.linspace(0.0, 1.0, 10_000, endpoint=False)
    torque = np.column_stack([np.sin(2.0 * np.pi * phase), np.ones_like(phase)])
    velocity = np.column_stack([np.sin(2.0 * np.pi * phase), -np.ones_like(phase)])
    found = profile(torque, velocity, phase)
    assert np.allclose(found.mean[:, 0], np.sinc(0.05) * np.sin(2.0 * np.pi * found.phase), atol=2e-3)
    assert np.allclose(found.power[:, 0], 0.5 - 0.5 * np.sinc(0.1) * np.cos(4.0 * np.pi * found.phase), atol=2e-3)
    assert np.allclose(found.rms[:, 1], 1.0)
    assert np.allclose(found.power[:, 1], -1.0)
    assert found.samples.sum() == len(phase)
