"""``exoid check`` prints findings; they do not change the exit status."""

import dataclasses
import json

import numpy as np
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
