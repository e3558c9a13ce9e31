"""``exoid select`` compares friction models, identifies with the best, and tests it once."""

import json
import sys

import numpy as np
import pytest
from typer.testing import CliRunner

import exoid
from exoid import Estimate
from exoid.cli import app, main
from exoid.identification.selection import friction_candidates, select_terms

TRAIN = ("bleex_swing", "bleex_swing:train")
FEW = ("--friction", "coulomb,load", "--folds", "3", "--stop", "8")


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The command on a part of a log, as JSON, with an estimate and a test."""
    path = tmp_path_factory.mktemp("select") / "est.json"
    result = CliRunner().invoke(
        app, ["select", *TRAIN, *FEW, "--test", "bleex_swing:test", "-o", str(path), "--json"], catch_exceptions=False
    )
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout), path


def test_json_is_all_there_is_on_standard_output_and_equals_the_api(run):
    data, _ = run
    log = exoid.datasets.bleex_swing()
    chosen = [candidate for candidate in friction_candidates() if candidate.name in ("coulomb", "load")]
    selection = select_terms(log.leg, log.train.between(0.0, 8.0), chosen, folds=3)
    assert data["chosen"] == selection.candidate.name
    assert [each["name"] for each in data["candidates"]][:2] == ["coulomb", "load"]
    np.testing.assert_allclose(data["candidates"][0]["folds"], selection.scores[0].folds, rtol=1e-9)


def test_the_choice_is_identified_written_and_tested_behind_the_common_filter(run):
    data, path = run
    estimate = Estimate.load(path)
    assert estimate.estimator == data["estimator"]
    assert data["test"]["joint_names"] == data["joint_names"] == list(estimate.joint_names)
    validation = exoid.validate(estimate, exoid.datasets.bleex_swing().test)
    if data["preparation"]["name"] == "zero-phase" and data["preparation"]["cutoff"] == data["cutoff"]:
        np.testing.assert_allclose(data["test"]["nrmse"], validation.nrmse, rtol=1e-6)
    assert all(error < 0.2 for error in data["test"]["nrmse"])


def test_a_friction_model_that_does_not_exist_is_refused_with_those_that_do(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["exoid", "select", *TRAIN, "--friction", "coulomb,magnet"])
    with pytest.raises(SystemExit) as stop:
        main()
    assert stop.value.code == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert (
        f"no friction model magnet. To fix it: use some of {', '.join(each.name for each in friction_candidates())}"
        in printed.err
    )


def test_progress_is_written_where_there_is_no_terminal(monkeypatch):
    monkeypatch.setattr("exoid.cli.progress.PATIENCE", 0.0)
    result = CliRunner().invoke(app, ["select", *TRAIN, *FEW, "--json"])
    assert result.exit_code == 0, result.output
    lines = [line for line in result.stderr.splitlines() if line.startswith("selecting friction")]
    assert lines[-1] == "selecting friction: 100 %"
    assert len(lines) >= 4
    json.loads(result.stdout)
