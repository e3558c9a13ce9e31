"""How surely variances are known: against textbooks, finite differences of dense formulas, and replicates."""

import dataclasses

import numpy as np
import pytest
from scipy.linalg import toeplitz
from scipy.signal import lfilter
from swings import TERMS, Swing

import exoid
from exoid.identification.estimators import ols, wls
from exoid.identification.group_rows import GroupRows
from exoid.identification.problem import Problem
from exoid.regression.fit import degrees_of_freedom
from exoid.regression.noise import AutoregressiveNoise
from exoid.regression.residuals import sandwich
from exoid.signals import FiniteDifference
from exoid.torques import TorqueModel

EXACT = FiniteDifference()


@pytest.fixture(scope="module")
def swing():
    return Swing(exoid.load_leg("bleex"), 50.0, 8.0)


def problem_of(swing, seed=0):
    noise = np.random.default_rng(seed).standard_normal(swing.torque.shape)
    tau = swing.torque + 0.3 * lfilter([1.0], [1.0, -0.7], noise, axis=0)
    return Problem.of_one(GroupRows(TorqueModel(swing.leg, TERMS), [swing.recording(tau=tau)], EXACT))


def autocovariances(sigma2, phi, count):
    """Of autoregressive noise, from its impulse response."""
    impulse = lfilter([1.0], np.concatenate([[1.0], -phi]), np.eye(1, 4000)[0])
    return sigma2 * np.correlate(impulse, impulse, "full")[3999 : 3999 + count]


def test_white_noise_of_one_joint_has_the_textbooks_samples_less_parameters():
    names = exoid.load_leg("bleex").joint_names
    leg = exoid.Leg.from_urdf(
        exoid.catalog.urdf_folder() / "bleex.urdf", names[:1], locked=dict.fromkeys(names[1:], 0.1)
    )
    problem = problem_of(Swing(leg, 50.0, 8.0))
    fit = ols(problem)
    (block,) = problem.blocks()
    count = len(block.rows.time)
    white = AutoregressiveNoise(np.zeros((1, 0)), np.array([0.1]), count)
    inverse = fit.solution.inverse
    solution = fit.solution._replace(covariance=0.1 * inverse)
    found = degrees_of_freedom(problem, fit.point, {(block.kind, 0): white}, solution, whitened=False)
    np.testing.assert_allclose(found, count - len(inverse), rtol=1e-9)


@pytest.mark.parametrize("whitened", [False, True], ids=["sandwich", "gls"])
def test_they_are_those_of_the_delta_method(swing, whitened):
    """2 V² / (gᵀ C g), g by central differences of dense formulas in ln σ² and φ of each joint.

    Whitening, they take the noise before the first sample for silent, which is a few percent in 400.
    """
    problem = problem_of(swing)
    fit = wls(problem)
    noises = {
        key: AutoregressiveNoise.from_autocovariances(
            autocovariances(noise.variances[-1], np.array([0.6, -0.2]), 3), 400
        )
        for key, noise in sandwich(problem, fit.point, fit.solution).noises.items()
    }
    assert {noise.order for noise in noises.values()} == {2}
    (block,) = problem.blocks()
    W = [weight * block.rows.W[:, j] for j, weight in enumerate(fit.weights)]
    thetas = [np.append(np.log(noise.variances[-1]), noise.predictors[-1]) for _, noise in sorted(noises.items())]
    start = np.array(thetas)

    def variances(thetas):
        gammas = [toeplitz(autocovariances(np.exp(t[0]), t[1:], len(block.rows.time))) for t in thetas]
        if whitened:
            return np.linalg.inv(sum(w.T @ np.linalg.solve(g, w) for w, g in zip(W, gammas, strict=True)))
        bread = np.linalg.inv(sum(w.T @ w for w in W))
        return bread @ sum(w.T @ g @ w for w, g in zip(W, gammas, strict=True)) @ bread

    spread, step = 0.0, 1e-4
    for joint, theta in enumerate(start):
        slopes = []
        for k in range(3):
            change = step * np.outer(np.arange(3) == joint, np.arange(3) == k)
            sides = [list(start + sign * change) for sign in (1.0, -1.0)]
            slopes.append(np.subtract(*(np.diag(variances(side)) for side in sides)) / (2.0 * step))
        gamma = toeplitz(autocovariances(np.exp(theta[0]), theta[1:], 2))
        C = np.zeros((3, 3))
        C[0, 0], C[1:, 1:] = 2.0 / 400, np.exp(theta[0]) * np.linalg.inv(gamma) / 400
        spread = spread + np.einsum("ki,kl,li->i", slopes, C, slopes)
    covariance = variances(start)
    left = 1.0 - len(problem.names) / 1200
    solution = fit.solution._replace(covariance=covariance)
    found = degrees_of_freedom(problem, fit.point, noises, solution, whitened=whitened)
    np.testing.assert_allclose(found, left * 2.0 * np.diag(covariance) ** 2 / spread, rtol=0.05 if whitened else 1e-4)


@pytest.mark.parametrize("estimator", ["wls", "gls"])
def test_variances_of_replicates_scatter_as_they_say(swing, estimator):
    """2 mean² / var of the variances of 60 replicates, and far fewer than effective samples say."""
    swing = dataclasses.replace(swing, seconds=12.0)
    rng = np.random.default_rng(4)
    estimates = []
    for _ in range(60):
        drive = lfilter([1.0], [1.0, -0.9], rng.standard_normal((200 + len(swing.torque), 3)), axis=0)[200:]
        recording = swing.recording(tau=swing.torque + 0.2 * drive)
        estimates.append(exoid.identify(swing.leg, recording, TERMS, estimator, preparation=EXACT))
    variances = np.array([estimate.std**2 for estimate in estimates])
    seen = 2.0 * variances.mean(axis=0) ** 2 / variances.var(axis=0, ddof=1)
    said = 1.0 / np.mean([1.0 / estimate.dof_each for estimate in estimates], axis=0)
    print("degrees of freedom, said over seen:", (said / seen).round(2), "said:", said.round())
    assert 0.6 < np.exp(np.log(said / seen).mean()) < 2.0
    assert said.min() < 0.5 * np.mean([estimate.dof for estimate in estimates])
    assert all((estimate.dof_each <= estimate.dof).all() for estimate in estimates)


def test_a_parameter_that_is_known_or_believed_has_as_many_as_the_noise(swing):
    """No noise of the recordings makes it unsure."""
    rng = np.random.default_rng(5)
    estimate = exoid.identify(
        swing.leg, swing.with_noise(rng, 0.3), TERMS, preparation=EXACT, known={"X1": 9.0}, prior={"J3": (0.06, 1e-6)}
    )
    places = [estimate.names.index(name) for name in ("X1", "J3")]
    np.testing.assert_array_equal(estimate.dof_each[places], estimate.dof)


def test_they_are_kept_in_the_file_and_older_files_have_one_number_for_all(swing, tmp_path):
    estimate = exoid.identify(swing.leg, swing.with_noise(np.random.default_rng(6), 0.3), TERMS, preparation=EXACT)
    estimate.save(tmp_path / "e.json")
    np.testing.assert_array_equal(exoid.Estimate.load(tmp_path / "e.json").interval(), estimate.interval())
    old = dataclasses.replace(estimate, dof_each=np.zeros(0))
    assert (old.dof_each == old.dof).all()
