"""Least squares on R factors equals the textbook, and its intervals contain the truth as often as they say."""

from typing import NamedTuple

import numpy as np
import pytest
from scipy import stats
from swings import TERMS, Swing
from unchecked import identify

import exoid
from exoid import ExoidError
from exoid.identification.estimators import ols, wls
from exoid.regression.every_row import make_rows
from exoid.regression.least_squares import RFactor, factorize_rows, solve
from exoid.signals import FiniteDifference
from exoid.torques import TorqueModel

NOISE = np.array([0.3, 0.2, 0.1])
PLAIN = FiniteDifference()


@pytest.fixture(scope="module")
def swing():
    return Swing(exoid.load_leg("bleex", inertias="identified"), base=0.15)


@pytest.fixture(scope="module")
def rows(swing):
    recording = swing.with_noise(np.random.default_rng(0), NOISE)
    return make_rows(TorqueModel(swing.leg, TERMS), recording, PLAIN)


class Reduced(NamedTuple):
    """Triangles and names: all that least squares asks of a problem."""

    r_factors: list
    names: tuple

    def solve(self, r_factor):
        return solve(r_factor, self.names)


def test_the_triangle_gives_what_lstsq_gives_on_all_rows(rows, swing):
    W, tau = rows.W.reshape(-1, rows.W.shape[-1]), rows.tau.ravel()
    expected, (squares,), _, _ = np.linalg.lstsq(W, tau)
    r_factors = factorize_rows(rows)
    solution = ols(Reduced(r_factors, TorqueModel(swing.leg, TERMS).names)).solution
    np.testing.assert_allclose(solution.values, expected, rtol=1e-10, atol=1e-12)
    assert sum(t.residual(solution.values) ** 2 for t in r_factors) == pytest.approx(squares, rel=1e-10)
    unit = W / np.linalg.norm(W, axis=0)
    assert solution.condition_number == pytest.approx(np.linalg.cond(unit), rel=1e-8)


def test_weights_are_the_residuals_of_each_joint(rows, swing):
    """The same as scaling the rows of each joint by its own residual RMS."""
    names = TorqueModel(swing.leg, TERMS).names
    r_factors = factorize_rows(rows)
    first = ols(Reduced(r_factors, names)).solution.values
    rms = np.sqrt(np.mean((rows.tau - rows.W @ first) ** 2, axis=0))
    W, tau = (rows.W / rms[:, None]).reshape(-1, len(names)), (rows.tau / rms).ravel()
    expected, *_ = np.linalg.lstsq(W, tau)
    solution = wls(Reduced(r_factors, names)).solution
    np.testing.assert_allclose(solution.values, expected, rtol=1e-9, atol=1e-11)
    residual = tau - W @ expected  # and the classical covariance, s² (WᵀW)⁻¹ with s² = ‖residual‖² / (rows − P)
    assert solution.dof == len(tau) - len(names)
    covariance = residual @ residual / solution.dof * np.linalg.inv(W.T @ W)
    np.testing.assert_allclose(solution.covariance, covariance, rtol=1e-7, atol=1e-12)


def test_a_joint_of_small_torques_is_not_sacrificed():
    """The model lacks most of a large torque, which looks like a parameter of the small one."""
    x, y, noise = np.random.default_rng(3).standard_normal((3, 400))
    large = np.column_stack([1000.0 * x, 0.3 * y, 1000.0 * x + 0.3 * 2.0 * y + 1000.0 * y])
    small = np.column_stack([x, y, x + 2.0 * y + 1e-3 * noise])
    triangles = [RFactor(np.linalg.qr(rows, mode="r"), 400, 400.0) for rows in (large, small)]
    assert wls(Reduced(triangles, ("J1", "J2"))).solution.values == pytest.approx([1.0, 2.0], abs=1e-3)


def test_units_of_the_parameters_do_not_matter():
    """A column a million times larger gives a value a million times smaller, to the last digits."""
    rng = np.random.default_rng(5)
    W, tau = rng.standard_normal((50, 3)), rng.standard_normal(50)
    scale = np.array([1e6, 1.0, 1e-6])
    one, other = (
        solve(RFactor(np.linalg.qr(np.column_stack([x, tau]), mode="r"), 50, 50.0), "abc") for x in (W, W * scale)
    )
    np.testing.assert_allclose(other.values * scale, one.values, rtol=1e-12)
    assert other.condition_number == pytest.approx(one.condition_number, rel=1e-9)


@pytest.mark.parametrize("level", [0.5, 0.9, 0.95, 0.99])
def test_intervals_are_students(swing, level):
    estimate = identify(swing.leg, swing.with_noise(np.random.default_rng(7), NOISE), TERMS)
    low, high = stats.t(estimate.dof_each, loc=estimate.values, scale=estimate.std).interval(level)
    np.testing.assert_allclose(estimate.interval(level), np.column_stack([low, high]), rtol=1e-12)


@pytest.mark.parametrize("level", [0.0, 1.0, -0.1, 95.0, float("nan")])
def test_an_interval_of_an_impossible_level_is_refused(swing, level):
    estimate = identify(swing.leg, swing.with_noise(np.random.default_rng(7), NOISE), TERMS)
    with pytest.raises(ExoidError, match="between 0 and 1"):
        estimate.interval(level)


def replicates(swing, count, std, **options):
    rng = np.random.default_rng(20)
    return [identify(swing.leg, swing.with_noise(rng, std), TERMS, **options) for _ in range(count)]


@pytest.mark.nightly
def test_weighting_beats_ordinary_least_squares_where_joints_differ_in_noise():
    """Hip torque errs ten times as much as the others'; parameters of knee and ankle gain by it."""
    swing = Swing(exoid.load_leg("bleex"), seconds=10.0, base=0.2)
    error = {
        estimator: np.array([e.values for e in replicates(swing, 60, [1.0, 0.1, 0.1], estimator=estimator)])
        - swing.truth
        for estimator in ("ols", "wls")
    }
    ratio = (error["wls"] ** 2).mean(axis=0) / (error["ols"] ** 2).mean(axis=0)
    print("mean squared error, wls over ols:", ratio.round(3))
    names = list(TorqueModel(swing.leg, TERMS).names)
    assert ratio[names.index("J2")] < 0.5
    assert ratio[names.index("J3")] < 0.5
    assert ratio.max() < 1.15
    assert np.median(ratio) < 0.7
