"""What is known beside the logs, and estimates side by side, on the command line."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

import exoid
from exoid import Estimate
from exoid.cli import app

LOG = "bleex_swing:train"


def run(*arguments):
    return CliRunner().invoke(app, list(arguments), catch_exceptions=True)


def test_known_prior_and_bounds_reach_the_estimate(tmp_path, data):
    path = tmp_path / "e.json"
    done = run(
        "identify", "bleex_swing", LOG, "-o", str(path), "--known", "X1=4.1",
        "--prior", "J3=0.05:0.01", "--prior", "Y3=0.1±0.02", "--nonnegative", "--no-check",
    )  # fmt: skip
    assert done.exit_code == 0, done.output
    estimate = Estimate.load(path)
    assert estimate.value("X1") == 4.1
    assert dict(estimate.prior_knowledge.prior.values) == {"J3": (0.05, 0.01), "Y3": (0.1, 0.02)}
    assert estimate.prior_knowledge.nonnegative
    same = exoid.identify(
        data.leg, data.train, known={"X1": 4.1}, prior=dict(estimate.prior_knowledge.prior.values),
        nonnegative=True, check=False,
    )  # fmt: skip
    np.testing.assert_allclose(estimate.covariance, same.covariance, rtol=1e-9)
    assert "known: X1 = 4.1" in done.output


def test_compare_prints_a_table_or_json(tmp_path, data):
    two, halves = [str(tmp_path / name) for name in ("a.json", "b.json")], (data.train, data.test)
    estimates = [exoid.identify(data.leg, half, check=False) for half in halves]
    for estimate, path in zip(estimates, two, strict=True):
        estimate.save(path)
    expected = exoid.compare(*estimates)
    printed = run("compare", *two)
    assert printed.exit_code == 0
    assert printed.output.strip() == str(expected).strip()
    data = json.loads(run("compare", *two, "--json").output)
    assert data["p_value"] == pytest.approx(expected.p_value)
    assert set(data["difference"]) == set(expected.names)
