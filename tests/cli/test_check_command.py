"""``exoid check`` prints findings; they do not change the exit status."""

import dataclasses
import json

import numpy as np
import pytest
from typer.testing import CliRunner

import exoid
from exoid.cli.app import app

RUN = CliRunner()


def test_a_log_without_faults():
    done = RUN.invoke(app, ["check", "bleex", "bleex_swing:train"])
    assert (done.exit_code, done.output) == (0, "nothing found\n")


def test_a_late_log_as_table_and_json(tmp_path):
    log = exoid.datasets.bleex_swing().train
    tau = np.array([np.interp(log.time - 0.02, log.time, x) for x in log.tau.T]).T
    dataclasses.replace(log, tau=tau).to_csv(tmp_path / "late.csv")
    table = RUN.invoke(app, ["check", "bleex", str(tmp_path / "late.csv")])
    assert table.exit_code == 0
    assert "torque-delay" in table.output
    done = RUN.invoke(app, ["check", "bleex", str(tmp_path / "late.csv"), "--json"])
    (finding,) = json.loads(done.output)["findings"]
    assert finding["kind"] == "torque-delay"
    assert abs(finding["value"] - 0.02) < 0.001
    mended = RUN.invoke(app, ["identify", "bleex", str(tmp_path / "late.csv"), "--delay", "auto", "--json"])
    assert [f["severity"] for f in json.loads(mended.output)["findings"]] == ["info"] * 3
    silent = RUN.invoke(app, ["identify", "bleex", str(tmp_path / "late.csv"), "--no-check", "--json"])
    assert json.loads(silent.output)["findings"] == []


@pytest.mark.parametrize("mistake", ["unsigned-torque", "gravity-compensated-effort"])
def test_torques_that_are_none_are_named(tmp_path, mistake):
    """A drive that logs the magnitude of its current, and a controller whose effort leaves gravity out."""
    data = exoid.datasets.bleex_swing()
    tau = data.train.tau - data.leg.gravity(data.train.q) if mistake.startswith("grav") else np.abs(data.train.tau)
    dataclasses.replace(data.train, tau=tau).to_csv(tmp_path / "log.csv")
    done = RUN.invoke(app, ["check", "bleex", str(tmp_path / "log.csv"), "--json"])
    found = [one for one in json.loads(done.output)["findings"] if one["severity"] == "error"]
    assert {one["kind"] for one in found} == {mistake}
