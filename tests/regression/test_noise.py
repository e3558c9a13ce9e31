"""The autoregressive noise model against statsmodels, dense linear algebra and formulas."""

import numpy as np
import pytest
from scipy.linalg import toeplitz
from statsmodels.regression.linear_model import yule_walker
from statsmodels.tsa.arima_process import arma_acovf

from exoid.regression.noise import AutoregressiveNoise, autocovariance_sums

AR = {"AR(1)": [0.8], "AR(2) resonance": [1.6, -0.9], "AR(3)": [0.5, -0.2, 0.3], "white": []}


@pytest.fixture(params=AR.values(), ids=AR)
def phi(request):
    return np.array(request.param)


@pytest.fixture
def gamma(phi):
    """Exact autocovariances of noise with innovations of variance 2, (400,)."""
    return arma_acovf(np.r_[1.0, -phi], [1.0], 400, sigma2=2.0)


@pytest.fixture
def noise(gamma):
    """Found from the first eleven autocovariances as if of so many samples that AIC errs no more."""
    return AutoregressiveNoise.from_autocovariances(gamma[:11], 10**6)


def test_exact_autocovariances_give_the_noise_back(noise, phi, gamma):
    assert noise.order == len(phi)
    np.testing.assert_allclose(noise.predictors[-1], phi, atol=1e-9)
    assert noise.variances[-1] == pytest.approx(2.0)
    correlations = [noise.autocorrelation(lag) for lag in range(20)]
    np.testing.assert_allclose(correlations, gamma[:20] / gamma[0], atol=1e-9)


@pytest.mark.filterwarnings("ignore::FutureWarning")
def test_yule_walker_is_that_of_statsmodels():
    x = np.random.default_rng(0).standard_normal(500).cumsum() * 0.1 + np.random.default_rng(1).standard_normal(500)
    gamma = autocovariance_sums(x, 7) / 500
    noise = AutoregressiveNoise.from_autocovariances(gamma, 10**9)
    assert noise.order == 7
    expected, sigma = yule_walker(x, 7, method="mle", demean=False)[:2]
    np.testing.assert_allclose(noise.predictors[-1], expected, rtol=1e-9)
    assert noise.variances[-1] == pytest.approx(sigma**2)


def test_the_quadratic_form_is_that_of_the_covariance(noise, gamma):
    X = np.random.default_rng(2).standard_normal((4, 300))
    X[:, 100:130] = 0.0
    np.testing.assert_allclose(noise.quadratic_form(X), X @ toeplitz(gamma[:300]) @ X.T, rtol=1e-4, atol=1e-2)


def test_the_effective_share_is_the_formula(noise, gamma):
    assert noise.effective_share == pytest.approx(gamma[0] ** 2 / (gamma[0] ** 2 + 2.0 * (gamma[1:] ** 2).sum()), 1e-6)


@pytest.mark.parametrize("samples", [1, 5, 6, 7, 50, 60, 61])
def test_autocovariance_sums_are_sums_of_products(samples):
    x = np.random.default_rng(3).standard_normal((2, samples))
    expected = [sum((row[: max(0, samples - k)] * row[k:]).sum() for row in x) for k in range(6)]
    np.testing.assert_allclose(autocovariance_sums(x, 5), expected, rtol=1e-10, atol=1e-12)


def test_silence_has_no_noise():
    noise = AutoregressiveNoise.from_autocovariances(np.zeros(5), 100)
    assert (noise.order, noise.variances.tolist(), noise.effective_share) == (0, [0.0], 1.0)


def test_autocovariances_of_no_noise_at_all_end_the_search():
    """γ_1 > γ_0 belongs to nothing; a correction for lost degrees of freedom can produce it."""
    assert AutoregressiveNoise.from_autocovariances(np.array([1.0, 1.2, 0.3]), 100).order == 0
