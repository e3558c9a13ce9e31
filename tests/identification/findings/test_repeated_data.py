"""A log that is passed twice counts once; parts that overlap make all parameters doubtful."""

import dataclasses

import numpy as np
import pytest
from logs import clean, kinds, of_kind

import exoid
from exoid.identification.recording_summary import evidence
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
    assert kinds(exoid.check(leg, [log, log])) == {"repeated-data"}


@pytest.mark.parametrize("read", [Recordings.from_files, lambda paths: [exoid.Recording.from_csv(p) for p in paths]])
def test_copies_of_a_file_count_once_in_memory_and_on_disk(tmp_path, read):
    leg, log = clean()
    paths = [tmp_path / "log.csv", tmp_path / "copy.csv", tmp_path / "other.csv"]
    log.to_csv(paths[0])
    paths[1].write_bytes(paths[0].read_bytes())
    clean(seed=2)[1].to_csv(paths[2])
    found = exoid.identify(leg, read(paths))
    assert [source.name for source in found.inputs] == ["log.csv", "other.csv"]
    assert of_kind(found.findings, "repeated-data").recording == "copy.csv"


def test_in_groups_a_log_counts_once_in_its_group():
    leg, log = clean()
    found = exoid.identify(leg, {"monday": [log, log], "tuesday": clean(seed=2)[1]}, own="offset")
    assert kinds(found["monday"].findings) == {"repeated-data"}
    assert found["tuesday"].findings == ()


def test_parts_of_one_log_are_not_the_same():
    leg, log = clean()
    halves = [log.slice(0, 1500), log.slice(1500, len(log))]
    found = exoid.identify(leg, halves)
    assert len(found.inputs) == 2
    assert found.findings == ()


@pytest.mark.parametrize("overlap", [200, 1000])
def test_samples_of_halves_that_overlap_count_once(overlap):
    """The result is that of the first half and of the rest of the log as a segment."""
    leg, log = clean()
    middle = len(log) // 2
    first, second = log.slice(0, middle + overlap // 2), log.slice(middle - overlap // 2, len(log))
    found = exoid.identify(leg, [first, second])
    finding = of_kind(found.findings, "repeated-data")
    assert finding.value == pytest.approx(overlap / (middle + overlap // 2), abs=0.01)
    assert finding.message.endswith("of their samples: counted once")
    rest = dataclasses.replace(second, mask=np.arange(len(second)) >= overlap)
    once = exoid.identify(leg, [first, rest])
    np.testing.assert_array_equal(found.values, once.values)
    np.testing.assert_array_equal(found.covariance, once.covariance)
    assert once.findings == ()
    assert kinds(exoid.check(leg, [first, second])) == {"repeated-data"}
    assert np.mean(found.std / exoid.identify(leg, log).std) > 0.97  # 0.87 if a third of the samples counted twice


def test_recordings_on_disk_that_overlap_make_all_parameters_doubtful(tmp_path):
    """They are not kept in memory to mask their samples."""
    leg, log = clean()
    log.slice(0, 1700).to_csv(tmp_path / "a.csv")
    log.slice(1500, len(log)).to_csv(tmp_path / "b.csv")
    found = exoid.identify(leg, Recordings.from_folder(tmp_path))
    assert "count twice" in of_kind(found.findings, "repeated-data").message
    assert found.doubtful == set(found.names)
    assert "well" not in found.identifiability


def test_the_same_log_with_other_stamps_is_found():
    leg, log = clean()
    later = dataclasses.replace(log, time=log.time + 100.0)
    assert of_kind(exoid.identify(leg, [log, later]).findings, "repeated-data").value == 1.0


def test_two_logs_of_the_same_motion_are_two():
    leg, log = clean()
    noise = 0.01 * np.random.default_rng(5).standard_normal(log.tau.shape)
    again = dataclasses.replace(log, tau=log.tau + noise)
    assert exoid.identify(leg, [log, again]).findings == ()


def test_the_hash_of_a_log_in_memory_is_also_that_of_its_forces_contacts_and_torso(data):
    force = np.outer(np.sin(data.test.time), [40.0, 0.0, 90.0])
    plain = dataclasses.replace(data.test, source=None, contacts={"left_foot": force[:, 2] > 0.0})
    logs = [plain, dataclasses.replace(plain, contacts={"left_foot": force[:, 2] > 1.0})]
    logs += [dataclasses.replace(plain, wrenches={"left_foot": exoid.Wrench(x * force, 0.0 * force)}) for x in (1, 2)]
    assert len({evidence(log).sha256 for log in logs}) == 4
    upright = clean()[1]
    tilted = [dataclasses.replace(upright, torso=exoid.TorsoMotion(pitch=0.1 * k)) for k in range(2)]
    assert len({evidence(log).sha256 for log in (upright, *tilted)}) == 3


def test_samples_at_rest_are_not_the_same_data():
    leg, log = clean()
    other = clean(seed=2)[1]
    rest = [
        dataclasses.replace(
            one,
            q=np.vstack([np.tile(log.q[:1], (300, 1)), one.q[300:]]),
            tau=np.vstack([np.tile(log.tau[:1], (300, 1)), one.tau[300:]]),
        )
        for one in (log, other)
    ]
    assert "repeated-data" not in kinds(exoid.check(leg, rest))
