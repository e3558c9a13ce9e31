"""Rows made stretch by stretch give the estimate of rows made at once, whatever goes over them."""

import dataclasses

import numpy as np
import pytest
from swings import TERMS, Swing, coloured
from unchecked import identify

import exoid
from exoid import Coulomb, Offset, Recording, Viscous
from exoid.identification.group_rows import Group
from exoid.identification.problem import Problem
from exoid.regression import rows as rows_module
from exoid.signals import FiniteDifference, MovingAverage, ZeroPhase
from exoid.torques import TorqueModel

SWING = Swing(exoid.load_leg("bleex"), 100.0, 60.0)
WITH_GAPS = (Coulomb(dead_band=0.1, reversal_speed=0.0), Viscous(), Offset())


def recording(seed: int = 0) -> Recording:
    """Correlated noise on the torques."""
    noise = coloured(np.random.default_rng(seed), SWING.torque.shape, 0.8)
    return SWING.recording(tau=SWING.torque + 0.5 * noise)


@pytest.fixture
def short_stretches(monkeypatch):
    """Hundreds of samples at once, and nothing kept from one pass to the next."""

    def shorten(reach: float = 8.0) -> None:
        monkeypatch.setattr(rows_module, "BLOCK", 700)
        monkeypatch.setattr(rows_module, "BLOCKS", 1)
        monkeypatch.setattr(rows_module, "REACHES", reach)
        monkeypatch.setattr("exoid.identification.group_rows.KEPT_BYTES", 0)

    return shorten


def test_fewer_rows_keep_the_torque_of_payloads():
    payload = exoid.Payload("knee", 2.0, (0.0, 0.0, -0.2))
    log = dataclasses.replace(SWING.recording(), payloads=(payload,))
    group = Group("", TorqueModel(SWING.leg, TERMS), [log], ZeroPhase())
    whole, few = rows_module.chain([*group.rows_of(0)]), group.decimated(0)
    same = np.isin(whole.time, few.time)
    assert 0 < len(few.time) < len(whole.time)
    assert all(np.array_equal(x[same], few.of_samples[name]) for name, x in whole.of_samples.items())
    assert few.known.any()


SLOW = [pytest.mark.slow]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("terms", "estimator", "preparation"),
    [
        pytest.param(terms, estimator, preparation, id=f"{name}-{estimator}-{preparation.name}", marks=marks)
        for terms, name, later in ((TERMS, "whole", pytest.mark.nightly), (WITH_GAPS, "with gaps", SLOW))
        for estimator in ("wls", "huber")
        for preparation, marks in ((ZeroPhase(), []), (FiniteDifference(), later), (MovingAverage(), later))
    ],
)
def test_the_estimate_is_that_of_all_rows_at_once(short_stretches, estimator, terms, preparation):
    logs = [recording(), recording(1).slice(0, 2500)]
    whole = identify(SWING.leg, logs, terms, estimator, preparation=preparation)
    short_stretches(1.0)
    parts = identify(SWING.leg, logs, terms, estimator, preparation=preparation)
    scale = np.abs(whole.values).max()
    np.testing.assert_allclose(parts.values, whole.values, rtol=1e-9, atol=1e-9 * scale)
    np.testing.assert_allclose(parts.std, whole.std, rtol=1e-6)
    np.testing.assert_allclose(parts.residual_rms, whole.residual_rms, rtol=1e-9)
    assert parts.dof == pytest.approx(whole.dof, rel=1e-6)
    for one, other in zip(parts.noise, whole.noise, strict=True):
        assert one.samples == other.samples
        assert one.order == other.order
        assert one.correlation == pytest.approx(other.correlation, abs=1e-9)
        assert one.whiteness == pytest.approx(other.whiteness, rel=1e-6, abs=1e-12)


def test_rows_come_in_several_stretches_that_cover_the_recording(short_stretches):
    short_stretches(1.0)
    problem = Problem((Group("", TorqueModel(SWING.leg, TERMS), [recording(), recording(1)], ZeroPhase()),))
    blocks = list(problem.blocks())
    prepared = rows_module.prepare(problem.single.model, recording(), ZeroPhase())
    whole = rows_module.form_rows(problem.single.model, prepared, prepared.rows)
    assert len(blocks) > 10
    half = blocks[: len(blocks) // 2]
    for name in ("time", "q", "usable"):
        joined = np.concatenate([getattr(block.rows, name) for block in half])
        np.testing.assert_array_equal(joined, getattr(whole, name))
    tau = np.concatenate([block.rows.tau for block in half])
    np.testing.assert_allclose(tau, whole.tau, rtol=0, atol=1e-11 * np.abs(whole.tau).max())
    W = np.concatenate([block.rows.W for block in half])
    np.testing.assert_allclose(W, whole.W, rtol=0, atol=1e-11 * np.abs(whole.W).max())


def test_decimated_rows_are_the_same_ones_in_stretches(short_stretches):
    problem = Problem((Group("", TorqueModel(SWING.leg, TERMS), [recording()], ZeroPhase()),))
    (whole,) = problem.recordings()
    short_stretches(1.0)
    (parts,) = Problem((Group("", problem.single.model, [recording()], ZeroPhase()),)).recordings()
    np.testing.assert_array_equal(parts.rows.time, whole.rows.time)
    np.testing.assert_allclose(parts.rows.W, whole.rows.W, rtol=0, atol=1e-11)
    assert parts.rows.stands_for == whole.rows.stands_for


@pytest.mark.parametrize("cutoff", [2.0, 6.0])
def test_rows_that_are_not_asked_for_change_no_other(cutoff):
    model = TorqueModel(SWING.leg, TERMS)
    prepared = rows_module.prepare(model, recording(), ZeroPhase(cutoff))
    (stretch,) = prepared.stretches()
    kept = rows_module.decimate(rows_module.form_rows(model, prepared, stretch), 0, len(prepared.rows))
    fewer = rows_module.decimated(prepared)
    (stretch,) = fewer.stretches()
    asked = rows_module.form_rows(model, fewer, stretch)
    assert len(asked.time) < len(prepared.rows)
    np.testing.assert_array_equal(asked.time, kept.time)
    np.testing.assert_allclose(asked.W, kept.W, atol=1e-11)
    assert asked.independent_fraction == kept.independent_fraction
