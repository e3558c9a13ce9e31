"""A band of predicted torque contains as many new torques as it says."""

import numpy as np
import pytest
from swings import TERMS, Swing
from unchecked import identify

import exoid
from exoid.regression.intervals import half_width
from exoid.signals import FiniteDifference, ZeroPhase

PLAIN = FiniteDifference()
NOISE = np.array([1.0, 0.7, 0.3])


@pytest.fixture(scope="module")
def swing():
    return Swing(exoid.load_leg("bleex"), 100.0, 10.0)


@pytest.fixture(scope="module")
def other(swing):
    """A motion that no estimate has seen."""
    return Swing(swing.leg, 100.0, 10.0, seed=9)


def test_the_band_of_a_measurement_contains_new_torques(swing, other):
    rng, inside, levels = np.random.default_rng(1), [], (0.5, 0.95)
    for _ in range(12):
        estimate = identify(swing.leg, swing.with_noise(rng, NOISE), TERMS, preparation=PLAIN)
        new = other.torque + rng.normal(scale=NOISE, size=other.torque.shape)
        bands = [estimate.torque_band(*other.motion, level=level) for level in levels]
        inside.append([((band.lower < new) & (new < band.upper)).mean(axis=0) for band in bands])
    coverage = np.mean(inside, axis=0)
    print(f"measured torque inside bands of {levels}: {coverage.round(3)}")
    np.testing.assert_allclose(coverage, np.tile(levels, (3, 1)).T, atol=0.02)


def test_behind_the_filter_it_contains_filtered_torques(swing, other):
    rng, inside = np.random.default_rng(2), []
    for _ in range(10):
        estimate = identify(swing.leg, swing.with_noise(rng, NOISE), TERMS)
        new = other.recording(tau=other.torque + rng.normal(scale=NOISE, size=other.torque.shape))
        found = exoid.validate(estimate, new)
        band = estimate.torque_band(*other.motion)
        inside.append((np.abs(found.residual) < np.median(band.upper - band.torque, axis=0)).mean(axis=0))
    coverage = np.mean(inside, axis=0)
    print(f"filtered torque inside: {coverage.round(3)}")
    np.testing.assert_allclose(coverage, 0.95, atol=0.035)


@pytest.mark.slow
def test_the_band_of_the_model_contains_the_torque_without_noise(swing, other):
    rng, inside = np.random.default_rng(3), []
    for _ in range(60):
        estimate = identify(swing.leg, swing.with_noise(rng, NOISE), TERMS, preparation=PLAIN)
        band = estimate.torque_band(*other.motion, measured=False)
        inside.append(((band.lower < other.torque) & (other.torque < band.upper)).mean())
    print(f"the model's torque inside: {np.mean(inside):.3f}")
    assert np.mean(inside) == pytest.approx(0.95, abs=0.035)
    wide = estimate.torque_band(*other.motion)
    assert ((wide.lower < band.lower) & (wide.upper > band.upper)).all()
    np.testing.assert_array_equal(band.torque, estimate.torque(*other.motion))


def test_its_width_is_that_of_the_covariance(swing, other):
    estimate = identify(swing.leg, swing.with_noise(np.random.default_rng(0), NOISE), TERMS, preparation=ZeroPhase(5.0))
    W = estimate.model.regressor(*other.motion)
    expected = np.sqrt(np.einsum("njp,pq,njq->nj", W, estimate.covariance, W))
    band = estimate.torque_band(*other.motion, measured=False)
    half = half_width(0.95, estimate.dof_each.min()) * expected
    np.testing.assert_allclose(band.upper - band.torque, half, rtol=1e-9)
    np.testing.assert_allclose(band.torque - band.lower, half, rtol=1e-9)
