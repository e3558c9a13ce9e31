"""Size of noise beside outliers and beside a smooth signal."""

import numpy as np
import pytest

from exoid.signals.cutoff import robust_std, white_noise


def test_outliers_hardly_change_the_robust_standard_deviation():
    x = 3.0 * np.random.default_rng(0).standard_normal(10_000)
    x[:200] = 1e6
    assert float(robust_std(x)) == pytest.approx(3.0, rel=0.05)


def test_white_noise_is_found_beside_a_motion():
    time = np.arange(0.0, 20.0, 0.002)
    sizes = np.array([1e-4, 0.05])
    noise = sizes * np.random.default_rng(1).standard_normal((len(time), 2))
    motion = np.column_stack([np.sin(6.0 * time), 9.81 + 3.0 * np.cos(9.0 * time)])
    np.testing.assert_allclose(white_noise(motion + noise), sizes, rtol=0.05)
