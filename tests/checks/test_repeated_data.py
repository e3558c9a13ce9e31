"""Data that occur twice count once, and a finding says so."""

import dataclasses

import numpy as np
import pytest
from logs import clean, kinds, of_kind

import exoid
from exoid.checks import count_once
from exoid.signals import Recordings


def test_the_same_log_twice_gives_the_estimate_of_once():
    leg, log = clean()
    once, twice = exoid.identify(leg, log), exoid.identify(leg, [log, log])
    np.testing.assert_array_equal(twice.values, once.values)
    np.testing.assert_array_equal(twice.covariance, once.covariance)
    finding = of_kind(twice.findings, "repeated-data")
    assert (finding.severity, finding.value, finding.parameters) == ("warning", 1.0, ())
    assert set(twice.identifiability) == {"well"}
    assert len(twice.inputs) == 1


def test_the_same_log_with_other_stamps_is_the_same_log():
    leg, log = clean()
    later = dataclasses.replace(log, time=log.time + 100.0)
    assert len(exoid.identify(leg, [log, later]).inputs) == 1


@pytest.mark.parametrize("overlap", [200, 1000])
def test_halves_that_overlap_count_once(overlap):
    leg, log = clean()
    middle = len(log) // 2
    halves = [log.slice(0, middle + overlap // 2), log.slice(middle - overlap // 2, len(log))]
    found = exoid.identify(leg, halves)
    assert sum(source.samples for source in found.inputs) == len(log)
    assert of_kind(found.findings, "repeated-data").value == pytest.approx(overlap / (middle + overlap // 2), abs=0.01)
    assert "repeated-data" in kinds(exoid.check(leg, halves))


def test_a_part_from_the_middle_leaves_both_ends():
    _, log = clean()
    whole = count_once([log.slice(1000, 2000), log])
    assert [len(one) for one in whole.data] == [1000, 1000, len(log) - 2000]


def test_two_logs_of_the_same_motion_are_two():
    leg, log = clean()
    noise = 0.01 * np.random.default_rng(5).standard_normal(log.tau.shape)
    again = dataclasses.replace(log, tau=log.tau + noise)
    assert exoid.identify(leg, [log, again]).findings == ()
    assert len(count_once([log, again]).data) == 2


def test_samples_at_rest_are_not_the_same_data():
    _, log = clean()
    q, tau = log.q.copy(), log.tau.copy()
    q[:300], tau[:300] = q[300], tau[300]
    rest = dataclasses.replace(log, q=q, tau=tau)
    other = dataclasses.replace(clean(seed=2)[1], time=log.time)
    start = dataclasses.replace(
        other, q=np.vstack([q[:300], other.q[300:]]), tau=np.vstack([tau[:300], other.tau[300:]])
    )
    assert count_once([rest, start]).findings == ()


def test_files_that_are_listed_twice_are_read_once(tmp_path):
    leg, log = clean()
    path = tmp_path / "log.csv"
    log.to_csv(path)
    listed = Recordings.from_files([path, path])
    once = count_once(listed)
    assert len(once.data) == 1
    assert once.findings[0].recording == "log.csv"
    assert "repeated-data" in kinds(exoid.identify(leg, listed).findings)
