"""What is known beside the logs, and estimates side by side, on the command line."""

import numpy as np
import pytest

import exoid
from exoid import Estimate

LOG = "bleex_swing:train"


def test_known_prior_and_bounds_reach_the_estimate(exoid_, data):
    given = ("--known", "X1=4.1", "--prior", "J3=0.05:0.01", "--prior", "Y3=0.1±0.02", "--nonnegative", "--no-check")
    printed = exoid_("identify", "bleex_swing", LOG, "-o", "e.json", *given).printed
    estimate = Estimate.load("e.json")
    assert estimate.value("X1") == 4.1
    assert dict(estimate.prior_knowledge.prior.values) == {"J3": (0.05, 0.01), "Y3": (0.1, 0.02)}
    assert estimate.prior_knowledge.nonnegative
    same = exoid.identify(
        data.leg, data.train, known={"X1": 4.1}, prior=dict(estimate.prior_knowledge.prior.values),
        nonnegative=True, check=False,
    )  # fmt: skip
    np.testing.assert_allclose(estimate.covariance, same.covariance, rtol=1e-9)
    assert "known: X1 = 4.1" in printed


def test_compare_prints_a_table_or_json(exoid_, data):
    two = ("a.json", "b.json")
    estimates = [exoid.identify(data.leg, half, check=False) for half in (data.train, data.test)]
    for estimate, path in zip(estimates, two, strict=True):
        estimate.save(path)
    expected = exoid.compare(*estimates)
    assert exoid_("compare", *two).printed.strip() == str(expected).strip()
    data = exoid_("compare", *two, "--json").data
    assert data["p_value"] == pytest.approx(expected.p_value)
    assert set(data["difference"]) == set(expected.names)
