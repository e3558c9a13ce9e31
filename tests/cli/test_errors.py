"""Whatever happens, a command ends in one line."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import exoid
from exoid.cli.app import describe_error
from exoid.cli.verbs import VERBS, load_verb

PROGRAM = "from exoid.cli import main; main()"


def fail(*_, **__):
    raise LookupError("one\ntwo")


def test_an_unexpected_error_is_one_line_and_the_traceback_an_option(exoid_, monkeypatch):
    monkeypatch.setattr(exoid, "load_leg", fail)
    run = exoid_("view", "bleex", "--html", "leg.html")
    assert (run.code, run.out) == (1, "")
    assert run.err.startswith("exoid: LookupError: one two. To fix it: run again with --traceback")
    assert run.err.count("\n") == 1
    for words in (("--traceback", "view", "bleex"), ("view", "bleex", "--traceback")):
        with pytest.raises(LookupError, match="one"):
            exoid_(*words)


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (OSError(28, "No space left on device", "/tmp/x"), "/tmp/x: No space left on device. To fix it: "),
        (MemoryError(), "not enough memory"),
        (ZeroDivisionError("float division"), "ZeroDivisionError: float division. To fix it: "),
    ],
)
def test_errors_of_the_system_are_told_from_those_of_the_program(error, words):
    line, status = describe_error(error)
    assert words in line
    assert "\n" not in line
    assert status == (1 if isinstance(error, ZeroDivisionError) else 2)


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
@pytest.mark.parametrize("verb", [("--help",), ("compare", "a.json", "b.json")])
def test_a_full_device_as_standard_output_is_one_line(verb, data, estimate, tmp_path):
    estimate.save(tmp_path / "a.json")
    exoid.identify(data.leg, data.test).save(tmp_path / "b.json")
    with Path("/dev/full").open("w", encoding="utf-8") as full:
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM, *verb],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
            cwd=tmp_path,
            env={name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"},
        )
    assert done.returncode == 2
    assert done.stderr == "exoid: No space left on device. To fix it: check this file, free space and permissions\n"


def test_the_package_runs_as_a_command():
    done = subprocess.run([sys.executable, "-m", "exoid", "validate"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("exoid: Missing argument ")
    assert done.stderr.endswith("see python -m exoid validate --help\n")


def test_a_warning_is_one_line_and_silent_in_a_quiet_command(data, tmp_path):
    exoid.identify(data.leg, data.test.slice(0, 700), (), check=False).save(tmp_path / "est.json")
    data.test.slice(0, 200).to_csv(tmp_path / "log.csv")
    for silent in ((), ("--quiet",)):
        words = ["track", "est.json", "--dry-run", "log.csv", *silent]
        command = [sys.executable, "-m", "exoid", *words]
        done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, check=True)
        assert done.stderr.count("\n") == (0 if silent else 1), done.stderr
        assert done.stderr.startswith("" if silent else "warning: not determined by the recordings")


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("identify", r"Missing argument '?LEG'?\. To fix it: see exoid identify --help"),
        ("idenify bleex", r"No such command 'idenify'.*[^?]\?? To fix it: see exoid --help"),
        ("identify bleex log.csv --cutof 3", r"No such option:? '?--cutof'?.*see exoid identify --help"),
        ("identify bleex log.csv --cutoff x", r"Invalid value for '--cutoff': [^.,]* a number\. To fix it"),
        ("plan bleex --starts x", r"Invalid value for '--starts': [^.,]* a whole number\. To fix it"),
        ("identify bleex log.csv --cutoff", r"Option '--cutoff' requires an argument"),
    ],
)
def test_wrong_options_and_arguments_are_one_line(exoid_, words, line):
    said = exoid_(*words.split()).refusal
    assert re.match(f"exoid: {line}", said), said


def test_without_a_verb_the_help_is_shown(exoid_):
    run = exoid_()
    assert run.code in (0, 2)
    assert "Usage: exoid" in run.out + run.err
    assert exoid_("--help").code == exoid_("identify", "--help").code == exoid_("--version").code == 0


@pytest.mark.parametrize("verb", VERBS)
def test_the_help_shows_every_unit(verb, exoid_, monkeypatch):
    """Rich takes [s] for markup, and drops it."""
    monkeypatch.setenv("COLUMNS", "400")
    known = load_verb(verb).params
    asked = [option for each in known for option in each.opts if option.startswith("--help-")]
    texts = [parameter.help for parameter in known if getattr(parameter, "help", None)]
    units = [word for text in texts for word in text.replace("\\[", "[").split() if word.startswith("[")]
    shown = "".join(exoid_(verb, option).out for option in ("--help", *asked))
    for unit in set(units):
        assert shown.count(unit) >= units.count(unit), unit
    assert "\\[" not in shown


@pytest.mark.parametrize("verb", VERBS)
def test_the_help_of_a_verb_shows_at_most_25_options_and_the_others_on_request(verb, exoid_):
    known = [each for each in load_verb(verb).params if each.param_type_name == "option"]
    asked = [option for each in known for option in each.opts if option.startswith("--help-")]
    usual, *groups = (exoid_(verb, option).out for option in ("--help", *asked))
    assert sum(line.startswith("  -") for line in usual.splitlines()) <= 25
    assert not re.search("<(str|int|float)>", usual)
    for option in (each.opts[0] for each in known):
        shown = sum(bool(re.search(rf"(^| |,){option}\b(?!-)", text, re.M)) for text in (usual, *groups))
        assert shown >= 1, option
