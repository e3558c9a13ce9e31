"""Recordings on disk, and on a Dask cluster, give the estimate of the same recordings in memory."""

from __future__ import annotations

import os
import pickle
import signal

import numpy as np
import pytest
from log_writers import write_parquet
from swings import TERMS, Swing
from unchecked import identify

import exoid
from exoid import ExoidError, Recording, Recordings
from exoid.signals import Cluster, FiniteDifference, Poses

SWING = Swing(exoid.load_leg("bleex"), 100.0, 30.0)


def recording(seed: int) -> Recording:
    """Correlated noise on the torques, and a motion that differs from seed to seed."""
    rng = np.random.default_rng(seed)
    noise = rng.normal(size=SWING.torque.shape)
    for k in range(1, len(noise)):
        noise[k] += 0.8 * noise[k - 1]
    return SWING.recording(tau=SWING.torque + 0.3 * noise).slice(100 * seed, 2900 - 50 * seed)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("logs")
    for seed in range(4):
        recording(seed).to_csv(path / f"part.{seed + 8}.csv")
    write_parquet(path / "part.12.parquet", recording(4))
    (path / "notes.md").write_text("not a log")
    return path


@pytest.fixture(scope="module")
def in_memory(folder):
    names = [f"part.{k}.csv" for k in range(8, 12)] + ["part.12.parquet"]
    return [Recording.from_file(folder / name) for name in names]


@pytest.fixture(scope="module")
def client():
    distributed = pytest.importorskip("distributed")
    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": ":0", "host": "127.0.0.1"}
    with distributed.LocalCluster(**options) as cluster, distributed.Client(cluster) as connected:
        yield connected


def assert_same(found, expected, *, inputs=True):
    np.testing.assert_allclose(found.values, expected.values, rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(found.covariance, expected.covariance, rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(found.residual_rms, expected.residual_rms, rtol=1e-9)
    assert found.dof == pytest.approx(expected.dof, rel=1e-9)
    assert found.preparation == expected.preparation
    assert found.identifiability == expected.identifiability
    np.testing.assert_allclose(found.influence.change, expected.influence.change, rtol=1e-6, atol=1e-6)
    for one, other in zip(found.trends, expected.trends, strict=True):
        np.testing.assert_allclose(one.mean, other.mean, rtol=1e-6, atol=1e-9)
        assert one.p_value == pytest.approx(other.p_value, rel=1e-4)
    if inputs:
        assert found.inputs == expected.inputs


SLOW = [pytest.mark.slow]


@pytest.mark.parametrize(
    ("kept", "estimator"),
    [
        pytest.param(kept, estimator, id=f"{where}-{estimator}", marks=marks)
        for kept, where in ((2**26, "kept in memory"), (0, "kept in files"))
        for estimator, marks in (("wls", []), ("ols", SLOW), ("gls", SLOW), ("huber", SLOW))
    ],
)
def test_a_folder_gives_the_estimate_of_its_logs_in_memory(folder, in_memory, estimator, kept, monkeypatch):
    monkeypatch.setattr("exoid.identification.group_rows.KEPT_BYTES", kept)
    found = identify(SWING.leg, Recordings.from_folder(folder), TERMS, estimator)
    assert_same(found, identify(SWING.leg, in_memory, TERMS, estimator))


@pytest.mark.parametrize(("check", "times"), [(False, 2), (True, 3)])
def test_every_log_is_read_twice_and_once_more_for_checks_and_none_of_them_is_kept(folder, check, times):
    read = []
    stored = Recordings.from_folder(folder).watched(lambda path: read.append(path.name))
    identify(SWING.leg, stored, check=check)
    once = [f"part.{k}.csv" for k in range(8, 12)] + ["part.12.parquet"]
    assert read == once * times


def test_logs_on_disk_go_with_poses_and_recordings_in_memory(folder, in_memory):
    rng = np.random.default_rng(1)
    q = rng.uniform(-1.0, 1.0, (60, 3))
    tau = SWING.leg.inverse_dynamics(q, 0 * q, 0 * q) + rng.normal(scale=0.1, size=q.shape)
    poses = Poses(q, tau, joint_names=SWING.leg.joint_names)
    mixed = [Recordings.from_folder(folder)[:3], poses, in_memory[4]]
    assert_same(exoid.identify(SWING.leg, mixed), identify(SWING.leg, [*in_memory[:3], poses, in_memory[4]]))


def test_they_are_a_sequence(folder):
    stored = Recordings.from_folder(folder)
    assert len(stored) == 5
    assert len(stored[1:3]) == 2
    assert stored[-1].source.name == "part.12.parquet"
    assert [each.source.name for each in stored[:2]] == ["part.8.csv", "part.9.csv"]


@pytest.mark.parametrize("name", ["nowhere", "empty", "file.csv"])
def test_a_folder_without_logs_is_refused(tmp_path, name):
    (tmp_path / "empty").mkdir()
    (tmp_path / "file.csv").write_text("time\n")
    with pytest.raises(ExoidError, match=r"no such folder|no logs in the folder"):
        Recordings.from_folder(tmp_path / name)


def test_a_damaged_log_is_named(folder, tmp_path):
    (tmp_path / "a.csv").write_bytes((folder / "part.8.csv").read_bytes())
    text = (folder / "part.9.csv").read_text().replace("\n", "\nnonsense", 500)
    (tmp_path / "b.csv").write_text(text)
    with pytest.raises(ExoidError, match=r"b\.csv"):
        identify(SWING.leg, Recordings.from_folder(tmp_path))


@pytest.mark.slow
@pytest.mark.parametrize("estimator", ["wls", "ols"])
def test_a_cluster_that_reads_files_gives_the_estimate_of_memory(client, folder, in_memory, estimator):
    found = exoid.identify(SWING.leg, Cluster.of_files(client, Recordings.from_folder(folder)), TERMS, estimator)
    assert_same(found, identify(SWING.leg, in_memory, TERMS, estimator))
    assert [(finding.kind, finding.severity) for finding in found.findings] == [("not-checked", "info")]


def test_workers_that_are_threads_of_this_process_do_not_wait_for_it(folder, in_memory):
    distributed = pytest.importorskip("distributed")
    # an address of its own: Dask asks the network for one, which may be missing
    options = {"n_workers": 2, "processes": False, "protocol": "tcp", "host": "127.0.0.1", "dashboard_address": ":0"}
    with distributed.LocalCluster(**options) as cluster, distributed.Client(cluster) as threads:
        found = identify(SWING.leg, Cluster.of_files(threads, Recordings.from_folder(folder)), TERMS)
    assert_same(found, identify(SWING.leg, in_memory, TERMS))


@pytest.mark.slow
def test_a_bag_and_an_array_of_dask_give_the_estimate_of_memory(client, in_memory):
    dask_bag, dask_array = pytest.importorskip("dask.bag"), pytest.importorskip("dask.array")
    expected = identify(SWING.leg, in_memory)
    bag = dask_bag.from_sequence(in_memory, npartitions=2)
    assert_same(identify(SWING.leg, Cluster.of_bag(client, bag)), expected)
    names = SWING.leg.joint_names
    quantities = [x for x in ("q", "v", "a", "tau") if getattr(in_memory[0], x) is not None]
    columns = ("time", *(f"{x}_{name}" for x in quantities for name in names))
    tables = [np.column_stack([each.time, *(getattr(each, x) for x in quantities)]) for each in in_memory]
    array = dask_array.concatenate([dask_array.from_array(table, chunks=(-1, 3)) for table in tables])
    assert_same(identify(SWING.leg, Cluster.of_array(client, array, columns)), expected, inputs=False)
    with pytest.raises(ExoidError, match="columns, 2 names"):
        Cluster.of_array(client, array, ("time", "q_hip"))


@pytest.mark.slow
def test_a_worker_that_dies_costs_only_time(folder, in_memory, monkeypatch):
    """It is killed when R factors are back; rows that it had kept for the noise model are made again elsewhere."""
    distributed = pytest.importorskip("distributed")
    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": ":0", "host": "127.0.0.1"}
    passes = []
    done = Cluster.map
    with distributed.LocalCluster(**options) as machine, distributed.Client(machine) as connected:

        def killing(self, work):
            found = done(self, work)
            passes.append(work)
            if len(passes) == 2:
                os.kill(next(iter(machine.workers.values())).pid, signal.SIGKILL)
            return found

        monkeypatch.setattr(Cluster, "map", killing)
        found = identify(SWING.leg, Cluster.of_files(connected, Recordings.from_folder(folder)), TERMS)
    assert len(passes) > 4
    assert_same(found, identify(SWING.leg, in_memory, TERMS))


@pytest.mark.slow
def test_free_settings_are_found_on_a_cluster_too(client, in_memory):
    terms = (exoid.Viscous(), exoid.torques.Stribeck(velocity=exoid.torques.NonlinearParameter(0.1, 0.01, 1.0)))
    bag = pytest.importorskip("dask.bag").from_sequence(in_memory[:2], npartitions=2)
    found, expected = identify(SWING.leg, Cluster.of_bag(client, bag), terms), identify(SWING.leg, in_memory[:2], terms)
    np.testing.assert_allclose(found.values, expected.values, rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(found.nonlinear.values, expected.nonlinear.values, rtol=1e-6)


@pytest.mark.slow
def test_rows_never_leave_the_workers(client, in_memory, monkeypatch):
    """What comes back is a few kilobytes for each recording and pass, whatever the number of samples."""
    sizes = []
    gather = type(client).gather

    def weighed(self, futures, **options):
        found = gather(self, futures, **options)
        sizes.extend(len(pickle.dumps(one)) for one in found)
        return found

    monkeypatch.setattr(type(client), "gather", weighed)
    dask_bag = pytest.importorskip("dask.bag")
    identify(SWING.leg, Cluster.of_bag(client, dask_bag.from_sequence(in_memory, npartitions=2)))
    rows = 8 * len(in_memory[0]) * 3 * 15
    assert len(sizes) > 20
    assert max(sizes) < 50_000 < rows


@pytest.mark.slow
def test_estimators_that_want_recordings_here_say_so(client, folder):
    cluster = Cluster.of_files(client, Recordings.from_folder(folder))
    for estimator in ("huber", "gls", "ml"):
        with pytest.raises(ExoidError, match="stay on the workers"):
            identify(SWING.leg, cluster, estimator=estimator)


@pytest.mark.slow
def test_errors_on_a_worker_come_back_as_they_are(client, folder):
    with pytest.raises(ExoidError, match="too few"):
        identify(SWING.leg, Cluster.of_files(client, Recordings.from_folder(folder)), cutoff=0.05)
    with pytest.raises(ExoidError, match="no such file"):
        identify(SWING.leg, Cluster.of_files(client, Recordings.from_files(["nowhere.csv"])))


def test_nobody_at_the_address_is_one_line(folder, monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr("exoid.signals.cluster.TIMEOUT", "1s")
    with pytest.raises(ExoidError, match="no Dask scheduler answers"):
        Cluster.of_files("tcp://127.0.0.1:9", Recordings.from_folder(folder))


@pytest.mark.slow
def test_rows_without_a_filter_are_made_again_rather_than_written(folder, in_memory, monkeypatch):
    monkeypatch.setattr("exoid.identification.group_rows.KEPT_BYTES", 0)
    expected = identify(SWING.leg, in_memory, preparation=FiniteDifference())
    assert_same(identify(SWING.leg, Recordings.from_folder(folder), preparation=FiniteDifference()), expected)
