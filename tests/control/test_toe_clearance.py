"""Clearance of a swinging foot: what is known of the hip and of the model decides its probability."""

from dataclasses import replace

import numpy as np
import pytest
from controlled_legs import exact_estimate
from scipy.stats import norm

from exoid.control import toe_clearance

TIME = np.arange(0.0, 0.6, 0.01)
SWING = np.column_stack([0.4 * np.sin(5.0 * TIME), 0.3 * np.cos(5.0 * TIME)])
GAINS = {"kp": 900.0, "kd": 60.0}


def height(q):
    return 0.05 - 0.02 * np.sin(q[:, 0] + q[:, 1])


@pytest.mark.parametrize("model", [0.0, 0.02])
def test_clearance_varies_as_hip_and_model_are_known(model):
    estimate = exact_estimate()
    known = replace(estimate, covariance=np.diag((model * estimate.values) ** 2))
    found = toe_clearance(known, TIME, SWING, height, carried_std=0.002, **GAINS)
    np.testing.assert_allclose(found.planned, height(SWING))
    of_hip = found.planned.min() + 0.002 * norm.ppf(0.05)
    assert found.least == pytest.approx(of_hip, abs=1e-4) if model == 0.0 else found.least < of_hip - 1e-5
    assert found.touches == 0.0
