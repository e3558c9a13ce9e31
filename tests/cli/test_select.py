"""``exoid select`` chooses the friction of each joint, and identifies with it."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

import exoid
from exoid import Estimate
from exoid.cli import app
from exoid.identification import select_terms

TRAIN = ("bleex_swing", "bleex_swing:train")
FEW = ("--folds", "3", "--stop", "8")


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The command on a part of a log, as JSON, with an estimate."""
    path = tmp_path_factory.mktemp("select") / "est.json"
    result = CliRunner().invoke(app, ["select", *TRAIN, *FEW, "-o", str(path), "--json"], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout), path


@pytest.mark.nightly
def test_json_is_all_there_is_on_standard_output_and_equals_the_api(run):
    data, _ = run
    log = exoid.datasets.bleex_swing()
    selection = select_terms(log.leg, log.train.between(0.0, 8.0), folds=3)
    assert data["chosen"] == selection.candidate.name
    assert [each["name"] for each in data["candidates"]][:2] == ["coulomb", "by joint"]
    np.testing.assert_allclose(data["candidates"][0]["folds"], selection.candidates[0].folds, rtol=1e-9)


@pytest.mark.slow
def test_the_choice_is_identified_and_written(run):
    data, path = run
    estimate = Estimate.load(path)
    assert data["joint_names"] == list(estimate.joint_names)
    assert (exoid.validate(estimate, exoid.datasets.bleex_swing().test).nrmse < 0.2).all()
