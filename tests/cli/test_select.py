"""``exoid select`` chooses the friction of each joint, and identifies with it."""

import json

import pytest
from typer.testing import CliRunner

import exoid
from exoid import Estimate
from exoid.cli import app

TRAIN = ("bleex_swing", "bleex_swing:train")
FEW = ("--folds", "3", "--stop", "8")


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The command on a part of a log, as JSON, with an estimate."""
    path = tmp_path_factory.mktemp("select") / "est.json"
    result = CliRunner().invoke(app, ["select", *TRAIN, *FEW, "-o", str(path), "--json"], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout), path


@pytest.mark.slow
def test_the_choice_is_identified_and_written(run):
    data, path = run
    estimate = Estimate.load(path)
    assert data["joint_names"] == list(estimate.joint_names)
    assert (exoid.validate(estimate, exoid.datasets.bleex_swing().test).nrmse < 0.2).all()
