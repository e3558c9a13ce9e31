"""The README's Python and its commands run as they stand, in a folder that has what its reader is assumed to have."""

from __future__ import annotations

import re
import shlex
import sys
from pathlib import Path

import numpy as np
import pytest

import exoid
from exoid.cli import main

README = Path(__file__).resolve().parents[1] / "README.md"
FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
BLOCKS = FENCE.findall(README.read_text(encoding="utf-8")) if README.is_file() else []
PYTHON = "".join(text for language, text in BLOCKS if language == "python")
SHELL = [text for language, text in BLOCKS if language in ("bash", "console", "sh")]
OUTPUT = [text for language, text in BLOCKS if language == "text"]

pytestmark = pytest.mark.skipif(not BLOCKS, reason="needs the source tree")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty folder with ``my_leg.urdf`` and ``log.csv``, as the section on one's own leg assumes."""
    monkeypatch.chdir(tmp_path)
    urdf = (exoid.catalog.urdf_folder() / "bleex.urdf").read_text(encoding="utf-8")
    Path("my_leg.urdf").write_text(urdf.replace("left_hip", "hip").replace("left_knee", "knee"), encoding="utf-8")
    train = exoid.datasets.bleex_swing().train.select(("left_hip", "left_knee"))
    table = np.column_stack([train.time, np.rad2deg(train.q), train.tau])
    np.savetxt("log.csv", table, delimiter=",", header="t,pos1,pos2,torque1,torque2", comments="")
    return tmp_path


def exoid_commands(text):
    """Commands of a block that start with exoid, those after ``&&`` included."""
    lines = [line.removeprefix("$ ") for line in text.splitlines() if not line.startswith("#")]
    parts = [part.strip() for line in lines for part in line.split("&&")]
    return [shlex.split(part) for part in parts if part.startswith("exoid ")]


@pytest.mark.usefixtures("folder")
def test_the_python_runs_from_top_to_bottom(capsys):
    exec(compile(PYTHON, str(README), "exec"), {"__name__": "readme"})
    out = capsys.readouterr().out
    assert "wls estimate of 20 parameters" in out
    assert "too few" in out


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize("block", [b for b in SHELL if exoid_commands(b)], ids=lambda b: exoid_commands(b)[0][2])
def test_the_commands_run(block, monkeypatch, capsys):
    shown = ""
    for command in exoid_commands(block):
        monkeypatch.setattr(sys, "argv", command)
        with pytest.raises(SystemExit) as stop:
            main()
        out, err = capsys.readouterr()
        if "cannot be downloaded" in err:
            pytest.skip("the DFKI recording is neither in $EXOID_DATA_DIR nor to be downloaded: see tests/datasets")
        assert not stop.value.code, err
        shown += out
    for output in OUTPUT:
        if output.splitlines()[0] in shown:
            assert output in shown, "the README shows what the command printed before"


def test_all_output_that_is_shown_is_tested():
    assert len(OUTPUT) == 2
    assert len([block for block in SHELL if exoid_commands(block)]) == 5


def test_the_first_lines_of_the_readme_have_the_two_commands():
    assert SHELL[0].splitlines()[1] == "pip install . && exoid reproduce bleex"
    assert SHELL[1].splitlines()[1] == "pip install '.[test]' && pytest"


def test_links_to_files_lead_somewhere():
    links = re.findall(r"\]\((?!https?:)([^)#]+)\)", README.read_text(encoding="utf-8"))
    assert links
    for link in links:
        assert (README.parent / link).is_file(), link


def test_every_parameter_is_in_the_table():
    text = README.read_text(encoding="utf-8")
    data = exoid.datasets.bleex_swing()
    names = exoid.identify(data.leg, data.train).names
    for symbol in {name.split("_")[0] for name in names if "_" in name}:
        assert f"`{symbol}_<joint>`" in text
