"""An estimate says which of its parameters deserve trust, and what its residuals look like."""

import numpy as np
import pytest
from swings import TERMS
from unchecked import identify

from exoid.regression.diagnostics import identifiability_class, other_scale, parameter_scale
from exoid.regression.fit import samples_left
from exoid.regression.least_squares import RFactor
from exoid.signals import FiniteDifference

EXACT = FiniteDifference()


@pytest.fixture(scope="module")
def estimate(swing):
    return identify(swing.leg, swing.with_noise(np.random.default_rng(0), 0.3), TERMS, preparation=EXACT)


@pytest.mark.parametrize(
    ("factor", "rows", "noise", "found"),
    [(2.0, 3, 0.1, 2.0), (0.8, 3, 0.01, 0.8), (0.84, 3, 0.01, 1.0), (2.0, 2, 0.1, 1.0), (2.0, 3, 2.0, 1.0)],
)
def test_another_scale_is_that_of_at_least_half_the_rows_and_their_residuals(factor, rows, noise, found):
    rng = np.random.default_rng(0)
    fitted = rng.standard_normal((1000, 6))
    tau = fitted * np.where(np.arange(6) < rows, factor, 1.0) + noise * rng.standard_normal((1000, 6))
    left = tau - fitted
    assert other_scale(np.sum([fitted**2, fitted * left, left**2], axis=1)) == pytest.approx(found, rel=0.05)


@pytest.mark.parametrize(
    ("value", "std", "size", "expected"),
    [
        *((2.0, 0.2, 0.0, "well"), (-2.0, 0.21, 0.0, "weakly"), (2.0, 0.61, 0.0, "not")),
        *((0.0, 0.09, 10.0, "well"), (0.0, 0.3, 10.0, "weakly"), (0.0, 0.31, 10.0, "not")),
        *((0.0, 0.0, 0.0, "well"), (0.0, 1e-9, 0.0, "not")),
    ],
)
def test_a_verdict_follows_its_thresholds(value, std, size, expected):
    assert identifiability_class(value, std, size) == expected


def test_sizes_are_what_explains_the_torque_of_a_joint_alone(swing):
    """‖τ‖ / ‖W_i‖ where that is smallest."""
    estimate = identify(swing.leg, swing.recording(), TERMS, preparation=EXACT)
    W = np.linalg.norm(estimate.model.regressor(*swing.motion)[1:-1], axis=0)
    tau = np.linalg.norm(swing.torque[1:-1], axis=0)
    expected = [min(tau[j] / W[j, i] for j in range(3) if W[j, i] > 0.0) for i in range(W.shape[1])]
    np.testing.assert_allclose(estimate.parameter_scale, expected, rtol=1e-9)


def test_a_parameter_that_left_no_trace_has_no_size():
    np.testing.assert_array_equal(parameter_scale([RFactor(np.diag([2.0, 0.0, 4.0]), 9, 9.0)]), [2.0, 0.0])


def test_degrees_of_freedom_are_those_of_the_group_that_determines_a_parameter():
    groups = [RFactor(np.diag([*sizes, 1.0]), 9, 9.0) for sizes in ((10.0, 0.1), (0.1, 10.0))]
    left, each = samples_left(groups, np.eye(2) / 100.01, [1000.0, 20.0], free=2)
    np.testing.assert_allclose([left, each], [(999.0, 19.0)] * 2, rtol=1e-3)


def test_white_residuals_are_called_white_and_all_count(estimate):
    for noise in estimate.noise:
        assert noise.whiteness > 0.01
        assert abs(noise.correlation) < 0.06
        assert 0.95 * noise.samples < noise.effective_samples <= noise.samples
    assert "residuals not white" not in str(estimate)


def test_residuals_with_memory_are_called_so_and_count_less(swing):
    rng = np.random.default_rng(2)
    noise = rng.standard_normal(swing.torque.shape).cumsum(axis=0)
    noise = 0.3 * (noise[20:] - noise[:-20])[: len(swing.torque)]
    tau = swing.torque + np.vstack([noise, np.zeros((20, 3))])
    estimate = identify(swing.leg, swing.recording(tau=tau), TERMS, preparation=EXACT)
    for of_joint in estimate.noise:
        assert of_joint.whiteness < 1e-6
        assert of_joint.correlation > 0.8
        assert of_joint.effective_samples < 0.2 * of_joint.samples
        assert of_joint.order > 0
    assert estimate.dof < 600
    assert "residuals not white: left_hip, left_knee, left_ankle" in " ".join(str(estimate).split())


@pytest.mark.slow
def test_whiteness_is_uniform_where_noise_is_white(swing):
    """One test in ten at the ten-percent level, of 90."""
    rng = np.random.default_rng(3)
    estimates = [identify(swing.leg, swing.with_noise(rng, 0.3), TERMS, preparation=EXACT) for _ in range(30)]
    share = np.mean([noise.whiteness < 0.1 for estimate in estimates for noise in estimate.noise])
    assert 0.02 < share < 0.22
