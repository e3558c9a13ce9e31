"""Recordings on disk give the estimate of the same recordings in memory."""

import numpy as np
import pytest
from log_writers import named_columns, write_columns
from swings import TERMS, Swing, coloured
from unchecked import identify

import exoid
from exoid import Recording, Recordings

SWING = Swing(exoid.load_leg("bleex"), 100.0, 30.0)


def recording(seed: int) -> Recording:
    """Correlated noise on the torques, and a motion that differs from seed to seed."""
    noise = coloured(np.random.default_rng(seed), SWING.torque.shape, 0.8)
    return SWING.recording(tau=SWING.torque + 0.5 * noise).slice(100 * seed, 2900 - 50 * seed)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("logs")
    for seed in range(4):
        recording(seed).to_csv(path / f"part.{seed + 8}.csv")
    write_columns(path / "part.12.parquet", **named_columns(recording(4)))
    (path / "notes.md").write_text("not a log")
    return path


@pytest.fixture(scope="module")
def in_memory(folder):
    names = [f"part.{k}.csv" for k in range(8, 12)] + ["part.12.parquet"]
    return [Recording.from_file(folder / name) for name in names]


def assert_same(found, expected, *, inputs=True):
    np.testing.assert_allclose(found.values, expected.values, rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(found.covariance, expected.covariance, rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(found.residual_rms, expected.residual_rms, rtol=1e-9)
    assert found.dof == pytest.approx(expected.dof, rel=1e-9)
    assert found.preparation == expected.preparation
    assert found.identifiability == expected.identifiability
    if inputs:
        assert found.inputs == expected.inputs


@pytest.mark.slow
@pytest.mark.parametrize(("kept", "estimator"), [(2**26, "wls"), *((0, name) for name in ("wls", "ols", "huber"))])
def test_a_folder_gives_the_estimate_of_its_logs_in_memory(folder, in_memory, estimator, kept, monkeypatch):
    monkeypatch.setattr("exoid.identification.group_rows.KEPT_BYTES", kept)
    found = identify(SWING.leg, Recordings.from_folder(folder), TERMS, estimator)
    assert_same(found, identify(SWING.leg, in_memory, TERMS, estimator))


@pytest.mark.slow
@pytest.mark.parametrize(("check", "times"), [(False, 2), (True, 3)])
def test_every_log_is_read_twice_and_once_more_for_checks_and_none_of_them_is_kept(folder, check, times, monkeypatch):
    read, of_item = [], Recordings.__getitem__
    monkeypatch.setattr(
        Recordings, "__getitem__", lambda self, k: read.append(self.items[k].path.name) or of_item(self, k)
    )
    identify(SWING.leg, Recordings.from_folder(folder), check=check)
    once = [f"part.{k}.csv" for k in range(8, 12)] + ["part.12.parquet"]
    assert read == once * times
