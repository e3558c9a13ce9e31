"""``exoid validate``: cut-off, verdict and exit status."""

import json
from dataclasses import replace
from functools import partial

import pytest


@pytest.fixture(scope="module")
def folder(tmp_path_factory, data, estimate):
    """An estimate, and logs with the other sign and with a heavier leg."""
    path = tmp_path_factory.mktemp("validate")
    estimate.save(path / "leg.json")
    for name, factor in (("negated", -1.0), ("heavier", 1.2)):
        replace(data.test, tau=factor * data.test.tau).to_csv(path / f"{name}.csv")
    return path


@pytest.fixture
def validate(folder, exoid_, monkeypatch):
    monkeypatch.chdir(folder)
    return partial(exoid_, "validate", "leg.json")


def test_an_estimate_that_predicts_ends_in_status_0(validate):
    code, out, err = validate("bleex_swing:test", "--strict")
    assert (code, err) == (0, "")
    assert "verdict: predicts\n" in out


def test_an_estimate_that_does_not_predict_ends_in_status_1_with_the_table(validate):
    code, out, err = validate("negated.csv")
    assert (code, err) == (1, "")
    assert "R²" in out
    assert "verdict: does not predict" in out


def test_a_poor_prediction_fails_only_under_strict(validate):
    code, out, _ = validate("heavier.csv", "--json")
    assert (code, json.loads(out)["verdict"]) == (0, "predicts poorly")
    code, strict, _ = validate("heavier.csv", "--json", "--strict")
    assert (code, strict) == (1, out)
