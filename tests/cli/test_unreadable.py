"""Files and folders that cannot be read end in one line that names them, whatever the verb."""

import os

import pytest
from log_writers import write_columns
from one_joint import swing, write_urdf

import exoid

LOCKED = "x" * 300
"""Folder whose name no system accepts: looking into it fails as it does without rights, also for root."""

COMMANDS = {
    "identify, log": "identify one.urdf {}/log.csv",
    "identify, URDF": "identify {}/one.urdf log.csv",
    "identify, output": "identify one.urdf log.csv -o {}/est.json",
    "identify, report": "identify one.urdf log.csv --report {}/report.html",
    "check": "check one.urdf {}/log.csv",
    "validate": "validate {}/est.json log.csv",
    "compare": "compare est.json {}/est.json",
    "export": "export {}/est.json -o leg.urdf",
    "export, C": "export est.json --c {}/leg.c",
    "plan, log": "plan one.urdf --assess {}/log.csv",
    "view, page": "view one.urdf --html {}/leg.html",
    "view, log": "view one.urdf --log {}/log.csv --html leg.html",
    "track, log": "track est.json --reference {}/log.csv",
    "track, figures": "track est.json --figures {}/figures",
    "track, report": "track est.json --report {}/report.html",
    "reproduce": "reproduce bleex --report {}/report.html",
}


@pytest.fixture(scope="module")
def inputs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("inputs")
    leg = write_urdf(folder / "one.urdf")
    swing(leg, seconds=5.0).to_csv(folder / "log.csv")
    exoid.identify(leg, exoid.Recording.from_csv(folder / "log.csv"), check=False).save(folder / "est.json")
    return folder


@pytest.fixture
def refused(inputs, tmp_path, exoid_):
    """Run a command beside links to the inputs; return its one line, which is no error of the program."""
    for name in ("one.urdf", "log.csv", "est.json"):
        (tmp_path / name).write_bytes((inputs / name).read_bytes())

    def run(*words):
        line = exoid_(*words).refusal
        assert "check this file, free space" not in line, "an error that only main() knows"
        assert "[Errno" not in line
        return line

    return run


@pytest.mark.parametrize("place", [LOCKED, "log.csv"], ids=["unreadable", "a file in place of the folder"])
@pytest.mark.parametrize("name", COMMANDS)
def test_a_folder_that_cannot_be_read_is_one_line(refused, name, place):
    line = refused(*COMMANDS[name].format(place).split())
    assert place[:40] in line or "a plan in" in line


def test_a_folder_in_place_of_a_file_is_called_a_folder(refused, tmp_path):
    (tmp_path / "logs").mkdir()
    assert "logs: is a folder, not a URDF file. To fix it: name the URDF file in it" in refused(
        "identify", "logs", "log.csv"
    )
    assert "logs: cannot be written: it is a folder" in refused("identify", "one.urdf", "log.csv", "-o", "logs")
    assert "logs: is a directory" in refused("validate", "logs", "log.csv")


def test_standard_output_in_a_file_is_no_output(tmp_path, refused, monkeypatch):
    """It would be replaced, and the table that is printed there lost."""
    with (tmp_path / "table.txt").open("w", encoding="utf-8") as file:
        monkeypatch.setattr("exoid.tools.files.STANDARD_OUTPUT", file.fileno())
        assert "it is the standard output" in refused("identify", "one.urdf", "log.csv", "-o", "table.txt")


@pytest.mark.parametrize("verb", ["identify", "select"])
def test_angles_and_commands_without_torque_end_in_what_columns_would_do(inputs, tmp_path, exoid_, verb):
    """The log of a position controller: it says which headers are torque, current or force."""
    log = exoid.Recording.from_csv(inputs / "log.csv")
    (name,) = log.joint_names
    q = log.q[:, 0]
    write_columns(tmp_path / "commands.csv", **{"time": log.time, f"q_{name}": q, f"q_cmd_{name}": q})
    line = exoid_(verb, inputs / "one.urdf", "commands.csv").refusal
    assert line.startswith("exoid: commands.csv: there is no torque, current or force")
    for column in (f"tau_{name}", "i_…", "f_…", "tm_…", f"--column tau_{name}=HEADER"):
        assert column in line


def test_what_has_no_end_is_refused_at_once(refused, tmp_path):
    """Devices and pipes: an estimate from /dev/zero took all memory, and one from a pipe waited for ever."""
    os.mkfifo(tmp_path / "pipe")
    for words in (("validate", "pipe", "log.csv"), ("validate", "/dev/zero", "log.csv")):
        assert "is a device or a pipe" in refused(*words)
    assert "is not a regular file" in refused("identify", "one.urdf", "pipe")
    for option in ("--actuators", "--columns"):
        assert "is a device or a pipe" in refused("identify", "bleex", "log.csv", option, "pipe")
