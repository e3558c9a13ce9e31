"""Torques that are stamped by another clock than the angles: their delay grows through the log."""

import dataclasses

import numpy as np
import pytest
from logs import clean, kinds, of_kind
from swings import late

import exoid


def drifting(recording, rate, seconds=0.0):
    """Stamp torques by a clock that is slow, and set wrong at the beginning."""
    t = recording.time
    stamps = t - rate * (t - t[0]) - seconds
    return dataclasses.replace(recording, tau=np.column_stack([np.interp(stamps, t, x) for x in recording.tau.T]))


@pytest.mark.parametrize("rate", [2e-4, -1e-3, pytest.param(1e-2, marks=pytest.mark.slow)])
def test_a_clock_that_drifts_is_found_with_its_rate(rate):
    leg, log = clean("cuhk", seconds=60.0)
    finding = of_kind(exoid.check(leg, drifting(log, rate)), "two-clocks")
    assert finding.joint == ""
    assert finding.value == pytest.approx(rate, rel=0.02, abs=1e-4)
    assert finding.interval[0] < finding.value < finding.interval[1]


def test_a_delay_at_the_beginning_is_found_beside_the_drift():
    leg, log = clean("cuhk", seconds=60.0)
    found = exoid.check(leg, drifting(log, 1e-3, 0.02))
    assert of_kind(found, "two-clocks").value == pytest.approx(1e-3, abs=1e-4)
    assert of_kind(found, "torque-delay").value == pytest.approx(0.02, abs=2e-3)


def test_a_delay_that_stays_is_no_drift():
    leg, log = clean("cuhk", seconds=60.0)
    assert kinds(exoid.check(leg, late(log, 0.03, [0, 1]))) == {"torque-delay"}


@pytest.mark.nightly
def test_a_long_log_of_which_parts_are_looked_at_has_one_clock(tmp_path):
    """Segments of 3 s are checked, in each of which the clocks part by less than a millisecond."""
    leg, log = clean("cuhk", seconds=60.0)
    time = np.linspace(log.time[0], log.time[-1], 120_000)
    for rate in (0.0, 3e-4):
        one = drifting(log, rate)
        q, tau = (np.column_stack([np.interp(time, one.time, x) for x in xs.T]) for xs in (one.q, one.tau))
        path = tmp_path / f"{rate}.csv"
        dataclasses.replace(one, time=time, q=q, tau=tau).to_csv(path)
        found = exoid.check(leg, exoid.Recording.from_csv(path))
        assert [f.value for f in found if f.kind == "two-clocks"] == pytest.approx([rate] * (rate > 0.0), abs=1e-4)
