"""``--columns LAB.TOML``: a laboratory writes its columns once."""

import numpy as np
import pytest
from log_writers import write_columns

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
        return exoid_("identify", "bleex", "log.csv", *arguments, "--no-check", "--json").data["values"]

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
    return write_columns(tmp_path / "log.csv", **columns)


def test_a_file_of_columns_says_what_the_options_say(values, log, tmp_path):
    (tmp_path / "lab.toml").write_text(TOML, encoding="utf-8")
    by_file = values("--columns", "lab.toml")
    assert by_file == values(*OPTIONS, "--unmeasured", "knee")


@pytest.mark.slow
def test_an_estimate_remembers_how_its_logs_were_read(exoid_, log):
    """The command line goes before it; --columns none forgets it."""
    options = (*OPTIONS, "--unmeasured", "knee")
    assert exoid_("identify", "bleex", "log.csv", *options, "--no-check", "-o", "est.json").printed
    told = exoid_("validate", "est.json", "log.csv", *options, "--json")
    alike = exoid_("validate", "est.json", "log.csv", "--json")
    assert (alike.code, alike.out) == (told.code, told.out)
    line = "columns and units of the logs as est.json remembers them; --columns none reads them as they stand\n"
    assert alike.err == line
    for verb in (("interaction", "est.json", "log.csv"), ("view", "est.json", "--log", "log.csv", "--html", "v.html")):
        also = exoid_(*verb)
        assert (also.code, also.err.startswith(line)) == (0, True), also.err
    assert exoid_("check", "bleex", "log.csv", "--columns", "est.json").code == 0
    other = exoid_("validate", "est.json", "log.csv", "--column", "tau_hip=cur:-0.059:3", "--json")
    assert other.out != alike.out
    assert "no column" in exoid_("validate", "est.json", "log.csv", "--columns", "none").err
    assert exoid_("validate", "est.json", "bleex_swing:test").err == ""
    again = exoid.Estimate.load("est.json")
    assert again.columns["columns"]["time"] == "t_ms:ms"


@pytest.mark.slow
def test_so_does_one_of_select(exoid_, log):
    part = (*OPTIONS, "--folds", "3", "--stop", "8", "-o", "est.json")
    assert exoid_("select", "bleex", "log.csv", *part).code == 0
    assert exoid_("validate", "est.json", "log.csv").code == 0


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("degree = true", "did you mean 'degrees'"),
        ("degrees = 1", "give true or false"),
        ("mask = 3", "give a text in quotes"),
        ("columns = 3", "columns is no table of texts"),
        ("[columns", "not TOML"),
        ("[delays]\nknee = '20 ms'", "write [delays] and below it knee = 0.02, in seconds"),
        ("[delays]\nknee = 20", "give seconds: 0.02 for 20 ms"),
        ("actuators = 'drives.toml'", "write [actuators.knee] and below it type"),
        ("[actuators.knee]\ntype = 'motr'", "lab.toml, [knee]: type is 'motr'"),
        ("[columns]\ntime = 't_ms:ms'\nq_hipp = 'encoder'", "--column q_hipp=HEADER"),
    ],
)
def test_mistakes_in_the_file_are_named(exoid_, log, tmp_path, text, what):
    whole = f"{TOML}\n{text}" if text.startswith(("[delays", "[actuators")) else text
    (tmp_path / "lab.toml").write_text(whole, encoding="utf-8")
    assert what in exoid_("identify", "bleex", "log.csv", "--columns", "lab.toml").refusal


LATE = 0.020  # the drive of the knee logs so much later than the encoders [s]
AMPERES = """
[columns]
time = "t_ms:ms"
q_hip = "enc_hip:deg"
q_knee = "enc_knee:deg"
q_ankle = "enc_ankle:deg"
i_hip = "cur_hip:mA"
i_knee = "cur_knee:mA"
i_ankle = "cur_ankle:mA"

[delays]
knee = 0.020

[actuators.hip]
type = "motor"
torque_constant = 0.1
ratio = 50
[actuators.knee]
type = "motor"
torque_constant = 0.12
ratio = 50
[actuators.ankle]
type = "motor"
torque_constant = "unknown"
ratio = 50
"""
CONSTANTS = {"hip": 0.1, "knee": 0.12, "ankle": 0.09}


@pytest.fixture
def amperes(tmp_path, data):
    """Two logs of currents, the knee's late, with a file of their columns, drives and delay."""
    for name, log in (("train.csv", data.train), ("test.csv", data.test)):
        columns = {"t_ms": 1e3 * log.time}
        for joint, (label, constant) in enumerate(CONSTANTS.items()):
            at = log.time - (LATE if label == "knee" else 0.0)
            columns[f"enc_{label}"] = np.rad2deg(log.q[:, joint])
            columns[f"cur_{label}"] = np.interp(at, log.time, log.tau[:, joint]) / (50 * constant) * 1e3
        write_columns(tmp_path / name, **columns)
    (tmp_path / "lab.toml").write_text(AMPERES, encoding="utf-8")


@pytest.mark.slow
def test_drives_and_delays_are_remembered_and_saved(exoid_, amperes, tmp_path):
    """The constant that was found goes before "unknown" in the file, which the user goes on giving."""
    assert exoid_("identify", "bleex", "train.csv", "--save-columns", "saved.toml").code != 0
    assert not (tmp_path / "saved.toml").exists()  # of a log that cannot be read with these columns
    options = ("identify", "bleex", "train.csv", "--no-check", "--json", "--columns")
    found = exoid_(*options, "lab.toml", "-o", "est.json", "--save-columns", "saved.toml").data
    assert exoid_(*options, "saved.toml").data["values"] == found["values"]
    for verb in ("validate", "interaction"):
        alike = exoid_(verb, "est.json", "test.csv", "--json").printed
        for file in ("lab.toml", "saved.toml", "est.json"):
            assert exoid_(verb, "est.json", "test.csv", "--json", "--columns", file).out == alike
    for verb in (
        ("view", "est.json", "--log", "test.csv"),
        ("view", "bleex", "--log", "test.csv", "--columns", "lab.toml"),
    ):
        assert exoid_(*verb, "--html", "v.html").printed
    assert exoid_("check", "bleex", "test.csv", "--columns", "est.json").out == "nothing found\n"
    assert "knee = 0.02" in (tmp_path / "saved.toml").read_text(encoding="utf-8")
