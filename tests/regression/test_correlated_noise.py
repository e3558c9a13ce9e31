"""Intervals that hold where the torque noise has a memory, and estimators that use or survive it."""

import dataclasses
import itertools

import numpy as np
import pytest
import statsmodels.api as sm
from scipy.linalg import toeplitz
from scipy.signal import lfilter
from swings import TERMS, Swing, coloured, holds
from unchecked import identify

import exoid
from exoid import Coulomb, Viscous
from exoid.identification.estimators import ols, wls
from exoid.identification.estimators.by_name import ESTIMATORS
from exoid.identification.group_rows import Group
from exoid.identification.problem import Problem
from exoid.regression.residuals import fit_noise, sandwich
from exoid.signals import FiniteDifference, Poses, ZeroPhase
from exoid.torques import TorqueModel

STD = np.array([1.0, 0.7, 0.3])
EXACT = FiniteDifference()


def noisy(swing, seed, time_constant=0.05, share=1.0):
    """Noise of which a share of the variance has a memory."""
    rng = np.random.default_rng(seed)
    memory = np.exp(-1.0 / (swing.rate * time_constant))
    shape = swing.torque.shape
    noise = np.sqrt(share) * coloured(rng, shape, memory) + np.sqrt(1.0 - share) * rng.standard_normal(shape)
    return swing.recording(tau=swing.torque + STD[: shape[1]] * noise)


def coverage(swing, replicates, share=1.0, **options):
    """Share of 95 % intervals that contain the truth, of all parameters and of the worst."""
    inside = []
    for seed in range(replicates):
        inside.append(holds(identify(swing.leg, noisy(swing, seed, share=share), TERMS, **options), swing.truth))
    return np.mean(inside), np.mean(inside, axis=0).min()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("estimator", "preparation", "share"),
    [
        pytest.param(*case, marks=[] if case[0] == "wls" or case[1:] == (ZeroPhase(), 0.8) else pytest.mark.nightly)
        for case in itertools.product(("wls", "huber"), (EXACT, ZeroPhase()), (0.0, 0.8, 1.0))
    ],
)
def test_intervals_hold_whatever_the_memory_of_the_noise(swing, estimator, preparation, share):
    """Nominal 95 %; scripts/study_intervals.py does it with 400 replicates."""
    mean, worst = coverage(swing, 25, share, estimator=estimator, preparation=preparation)
    print(f"coverage {estimator} {preparation.name} {share}: {mean:.3f}, worst {worst:.3f}")
    assert 0.89 < mean < 0.99
    assert worst >= 0.76


def problem_of(swing, seed, terms=TERMS, **changes):
    return Problem((Group("", TorqueModel(swing.leg, terms), [noisy(swing, seed, **changes)], EXACT),))


@pytest.mark.parametrize("terms", [TERMS, (Coulomb(dead_band=0.1), Viscous())], ids=["whole", "with gaps"])
def test_the_sandwich_is_the_textbooks(terms):
    """(WᵀW)⁻¹ Wᵀ Γ W (WᵀW)⁻¹ with dense matrices, also where samples are left out."""
    problem = problem_of(Swing(exoid.load_leg("bleex"), 100.0, 8.0), 1, terms)
    fit = wls(problem)
    covariance, _, noises = sandwich(problem, fit)
    (block,) = problem.blocks()
    bread, meat = 0.0, 0.0
    for joint, weight in enumerate(fit.weights):
        noise, use = noises[block.kind, joint], block.rows.usable[:, joint]
        impulse = lfilter([1.0], noise.polynomial, np.eye(1, 6000)[0])
        gamma = noise.variances[-1] * np.correlate(impulse, impulse, "full")[5999 : 5999 + len(use)]
        W = weight * block.rows.W[use, joint]
        bread, meat = bread + W.T @ W, meat + W.T @ toeplitz(gamma)[np.ix_(use, use)] @ W
    np.testing.assert_allclose(covariance, np.linalg.solve(bread, np.linalg.solve(bread, meat).T), rtol=2e-3, atol=1e-9)


@pytest.fixture(scope="module")
def pendulum():
    """One joint, so that an ordinary regression is the same problem."""
    names = exoid.load_leg("bleex").joint_names
    urdf = exoid.catalog.urdf_folder() / "bleex.urdf"
    return Swing(exoid.Leg.from_urdf(urdf, names[:1], locked={names[1]: 0.2, names[2]: 0.1}), 100.0, 60.0)


def regression_of(problem):
    (block,) = problem.blocks()
    return block.rows.W[:, 0], block.rows.tau[:, 0]


def test_the_sandwich_agrees_with_statsmodels_hac(pendulum):
    """On a long record HAC (Bartlett, 3 s) is right to a few percent, so both must be near each other."""
    problem = problem_of(pendulum, 3)
    fit = ols(problem)
    covariance, *_ = sandwich(problem, fit)
    W, tau = regression_of(problem)
    hac = sm.OLS(tau, W).fit(cov_type="HAC", cov_kwds={"maxlags": 60})
    np.testing.assert_allclose(fit.solution.values, hac.params, rtol=1e-8)
    ratio = np.sqrt(np.diag(covariance)) / hac.bse
    print("std, sandwich over HAC:", ratio.round(3))
    assert (np.abs(np.log(ratio)) < 0.35).all()
    assert (np.sqrt(np.diag(covariance)) > 1.5 * np.sqrt(np.diag(fit.solution.covariance)))[:2].all()


def test_huber_is_that_of_statsmodels(pendulum):
    problem = problem_of(pendulum, 6)
    rng = np.random.default_rng(7)
    (recording,) = problem.single.data
    tau = recording.tau + 20.0 * (rng.random(recording.tau.shape) < 0.05)
    problem = problem.changed(data=[dataclasses.replace(recording, tau=tau)])
    W, tau = regression_of(problem)
    expected = sm.RLM(tau, W, M=sm.robust.norms.HuberT()).fit()
    fit = ESTIMATORS["huber"](problem)
    np.testing.assert_allclose(fit.solution.values, expected.params, rtol=2e-3)
    assert 1.0 / fit.weights[0] == pytest.approx(expected.scale, rel=1e-3)


@pytest.mark.parametrize("estimator", sorted(set(ESTIMATORS) - {"ml"}))
def test_poses_and_recordings_of_several_rates_make_one_estimate(swing, estimator):
    rng = np.random.default_rng(10)
    q = rng.uniform(-1.0, 1.0, (12, 3))  # fewer than blocks of the jackknife
    tau = swing.leg.inverse_dynamics(q, 0.0 * q, 0.0 * q) + rng.normal(scale=STD, size=q.shape)
    slow = noisy(Swing(swing.leg, 50.0, seed=3), 11)
    data = [noisy(swing, 12), Poses(q, tau, swing.leg.joint_names), slow]
    estimate = identify(swing.leg, data, TERMS, estimator)
    assert (np.abs(estimate.values - swing.truth) < 4.5 * estimate.std).all()
    # errors of blocks scatter
    textbook, alone = (identify(swing.leg, x, TERMS, estimator, noise="white") for x in (data, data[0]))
    assert (textbook.std < 1.1 * alone.std).all()


def test_the_noise_found_is_the_noise_made(swing):
    problem = problem_of(swing, 14)
    fit = wls(problem)
    noises = fit_noise(problem, fit, fit.solution.covariance)
    for noise in noises.values():
        assert noise.predictors[-1][0] == pytest.approx(np.exp(-0.2), abs=0.06)
