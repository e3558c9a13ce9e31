"""``exoid coordinate`` runs a day, prints a table or JSON, and draws it."""

import pytest

pytest.importorskip("mujoco")


from exoid.lab.coordination.day import PLAN, run_function

SHORT = (("rise", 0.05), ("walk", 0.1))
"""A day of two functions."""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("plan", "share"), [(SHORT, 0.25), pytest.param(PLAN, 1.0, marks=pytest.mark.nightly)], ids=["short", "whole"]
)
def test_a_day_is_told_right(exoid_, tmp_path, monkeypatch, plan, share):
    """A short day follows a calibration that takes a share of its time."""

    def calibrating(plant, name, seconds, rng):
        return run_function(plant, name, share * seconds, rng)

    monkeypatch.setattr("exoid.lab.coordination.study.run_function", calibrating)
    monkeypatch.setattr("exoid.lab.coordination.day.PLAN", plan)
    options = ("--seconds", "30", "--events", "1", "--json", "--figures", str(tmp_path / "day"))
    data = exoid_("coordinate", "cuhk", *options).data
    assert data["mode_accuracy"] >= 0.99
    assert {name for name, _ in plan} == set(data["functions"])
    assert all(0.0 <= each["accuracy"] <= 1.0 for each in data["functions"].values())
    assert data["events"]["beyond_limits"] == 0
    assert {path.suffix for path in (tmp_path / "day").iterdir()} == {".pdf", ".svg"}


@pytest.mark.parametrize("arguments", [("panda",), ("bleex", "--seconds", "3"), ("bleex", "--events", "-1")])
def test_what_cannot_be_run_is_refused(exoid_, arguments, monkeypatch):
    monkeypatch.setattr("exoid.lab.coordination.study.calibrate", lambda plant, seed: None)
    assert exoid_("coordinate", *arguments).refusal
