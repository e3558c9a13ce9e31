"""``exoid validate`` and ``exoid interaction``: cut-off, verdict and exit status; table, JSON, CSV and strides."""

import dataclasses
import json

import numpy as np
import pytest

import exoid


@pytest.fixture(scope="module")
def folder(tmp_path_factory, data, estimate):
    """An estimate, and logs of the leg: with a wearer who pushes at 0.7 Hz, with the other sign, and heavier."""
    path, test = tmp_path_factory.mktemp("logs"), data.test
    estimate.save(path / "leg.json")
    push = 3.0 * np.sin(2.0 * np.pi * 0.7 * test.time)[:, None]
    for name, tau in (("worn", test.tau - push), ("negated", -test.tau), ("heavier", 1.2 * test.tau)):
        dataclasses.replace(test, tau=tau).to_csv(path / f"{name}.csv")
    return path


@pytest.fixture
def command(folder, exoid_, monkeypatch):
    monkeypatch.chdir(folder)
    return lambda verb, *words: exoid_(verb, "leg.json", *words)


def test_the_json_has_figures_of_each_joint_and_whether_the_leg_is_worn(command):
    done = command("interaction", "worn.csv", "--json")
    assert done.err == ""
    data = done.data
    assert data["worn"] is True
    for figures in data["joints"].values():
        assert figures["rms"] == pytest.approx(3.0 / np.sqrt(2.0), rel=0.05)
        assert figures["peak"] == pytest.approx(3.0, abs=0.6)
        assert figures["outside_band"] > 0.9
    assert command("interaction", "bleex_swing:test", "--json").data["worn"] is False


def test_the_table_ends_with_the_conclusion(command):
    assert "worn: something acts on left_hip, left_knee, left_ankle" in command("interaction", "worn.csv")[1]
    assert "not worn: nothing beyond model error" in command("interaction", "bleex_swing:test")[1]


def test_the_csv_holds_the_torque_and_its_band(command, tmp_path):
    path = tmp_path / "torque.csv"
    assert command("interaction", "worn.csv", "-o", str(path))[0] == 0
    header, *rows = [line.split(",") for line in path.read_text().splitlines() if not line.startswith("#")]
    table = dict(zip(header, np.array(rows, dtype=np.float64).T, strict=True))
    found = exoid.interaction(exoid.Estimate.load("leg.json"), exoid.Recording.from_csv("worn.csv"))
    assert np.array_equal(table["interaction_left_knee"], found.torque[:, 1])
    assert np.array_equal(table["band_left_knee"], found.band[:, 1])


def test_strides_give_the_phase(command):
    gait = command("interaction", "worn.csv", "--strides", "2,4,6,8", "--json").data["gait"]
    assert gait["period"] == 2.0
    assert len(gait["phase"]) == len(gait["joints"]["left_hip"]["power"]) == 20


def test_an_estimate_that_predicts_ends_in_status_0(command):
    code, out, err = command("validate", "bleex_swing:test", "--strict")
    assert (code, err) == (0, "")
    assert "verdict: predicts\n" in out


def test_an_estimate_that_does_not_predict_ends_in_status_1_with_the_table(command):
    code, out, err = command("validate", "negated.csv")
    assert (code, err) == (1, "")
    assert "R²" in out
    assert "verdict: does not predict" in out


def test_a_poor_prediction_fails_only_under_strict(command):
    code, out, _ = command("validate", "heavier.csv", "--json")
    assert (code, json.loads(out)["verdict"]) == (0, "predicts poorly")
    code, strict, _ = command("validate", "heavier.csv", "--json", "--strict")
    assert (code, strict) == (1, out)
