"""``--columns LAB.TOML``: a laboratory writes its columns once."""

from __future__ import annotations

import json

import numpy as np
import pytest

import exoid

OPTIONS = ("--column", "time=t_ms:ms", "--column", "q_hip=enc:deg", "--column", "tau_hip=cur:-0.118:3")
TOML = """
unmeasured = "knee"

[columns]
time = "t_ms:ms"
q_hip = "enc:deg"
tau_hip = "cur:-0.118:3"
"""


@pytest.fixture
def values(exoid_):
    """Identified values by name, as the command line prints them."""

    def identified(*arguments):
        run = exoid_("identify", "bleex", "log.csv", *arguments, "--no-check", "--json")
        assert run.code == 0, run.err
        return json.loads(run.out)["values"]

    return identified


@pytest.fixture
def log(tmp_path):
    """A log with headers, units and signs of a laboratory."""
    recording = exoid.datasets.bleex_swing().train
    columns = {
        "t_ms": 1e3 * recording.time,
        "enc": np.rad2deg(recording.q[:, 0]),
        "cur": 3 - recording.tau[:, 0] / 0.118,
    }
    for joint, name in ((1, "knee"), (2, "ankle")):
        columns |= {f"q_{name}": recording.q[:, joint], f"tau_{name}": recording.tau[:, joint]}
    path = tmp_path / "log.csv"
    np.savetxt(path, np.column_stack(list(columns.values())), delimiter=",", header=",".join(columns), comments="")
    return path


def test_a_file_of_columns_says_what_the_options_say(values, log, tmp_path):
    (tmp_path / "lab.toml").write_text(TOML, encoding="utf-8")
    by_file = values("--columns", "lab.toml")
    assert by_file == values(*OPTIONS, "--unmeasured", "knee")


def test_columns_are_saved_and_the_command_line_goes_before_the_file(values, log):
    first = values(*OPTIONS, "--unmeasured", "knee", "--save-columns", "saved.toml")
    assert values("--columns", "saved.toml") == first
    other = "tau_hip=cur:-0.059:3"
    halved = values(*OPTIONS[:-1], other, "--unmeasured", "knee")
    assert values("--columns", "saved.toml", "--column", other) == halved != first


def test_an_estimate_remembers_how_its_logs_were_read(exoid_, log):
    """The command line goes before it; --columns none forgets it."""
    run = exoid_("identify", "bleex", "log.csv", *OPTIONS, "--unmeasured", "knee", "--no-check", "-o", "est.json")
    assert run.code == 0, run.err
    told = exoid_("validate", "est.json", "log.csv", *OPTIONS, "--unmeasured", "knee", "--json")
    alike = exoid_("validate", "est.json", "log.csv", "--json")
    assert (alike.code, alike.out) == (told.code, told.out)
    line = "columns and units of the logs as est.json remembers them; --columns none reads them as they stand\n"
    assert alike.err == line
    for verb in (("interaction", "est.json", "log.csv"), ("view", "est.json", "--log", "log.csv", "--html", "v.html")):
        assert exoid_(*verb).err.startswith(line)
    assert exoid_("check", "bleex", "log.csv", "--columns", "est.json").code == 0
    other = exoid_("validate", "est.json", "log.csv", "--column", "tau_hip=cur:-0.059:3", "--json")
    assert other.out != alike.out
    assert "no column" in exoid_("validate", "est.json", "log.csv", "--columns", "none").err
    assert exoid_("validate", "est.json", "bleex_swing:test").err == ""
    again = exoid.Estimate.load("est.json")
    assert again.columns["columns"]["time"] == "t_ms:ms"
    assert exoid.Estimate.from_json(again.to_json()).columns == again.columns


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("degree = true", "did you mean 'degrees'"),
        ("degrees = 1", "give true or false"),
        ("start = 2.0", "keys are columns, plates, degrees"),
        ("mask = 3", "give a text in quotes"),
        ("wrench = 'left_foot:link'", "give a list of texts"),
        ("columns = 3", "columns is no table of texts"),
        ("[columns]\nq_hip = 3", "columns is no table of texts"),
        ("[columns", "not TOML"),
        ("[columns]\ntime = 't_ms:ms'\nq_hipp = 'encoder'", "--column q_hipp=HEADER"),
    ],
)
def test_mistakes_in_the_file_are_named(exoid_, log, tmp_path, text, what):
    (tmp_path / "lab.toml").write_text(text, encoding="utf-8")
    run = exoid_("identify", "bleex", "log.csv", "--columns", "lab.toml")
    assert run.code == 2
    assert what in run.err
