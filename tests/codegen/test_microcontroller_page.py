"""The page on microcontrollers does what it says: its commands, its program and its output."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from compiled import compile_c, needs_compiler

import exoid
from exoid.cli import main

PAGE = Path(__file__).resolve().parents[2] / "docs" / "microcontroller.md"
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.M | re.S) if PAGE.is_file() else []

pytestmark = [needs_compiler, pytest.mark.skipif(not BLOCKS, reason="needs the source tree")]


def test_the_commands_and_the_program_print_what_the_page_shows(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (commands, (_, program), (_, build), (_, shown)) = (BLOCKS[0][1], *BLOCKS[1:])
    for line in commands.splitlines():
        monkeypatch.setattr(sys, "argv", shlex.split(line))
        with pytest.raises(SystemExit) as stop:
            main()
        assert not stop.value.code, capsys.readouterr().err
    Path("main.c").write_text(program, encoding="utf-8")
    done = subprocess.run(build, shell=True, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == shown
    compile_c((), Path("main.c"), Path("leg.c"), to=Path("strict"))
    printed = [float(value) for value in re.findall(r": (\S+) N m", shown)]
    assert printed == pytest.approx(expected(exoid.Estimate.load("est.json")), abs=0.006)


def expected(estimate: exoid.Estimate) -> np.ndarray:
    """The law of the page in Python."""
    qd, vd = np.array([0.35, -0.50, 0.10]), np.array([0.8, -0.4, 0.2])
    q, v = np.array([0.30, -0.55, 0.12]), np.array([0.7, -0.5, 0.1])
    rows = estimate.model.regressor(np.zeros(3), vd, np.zeros(3))[0]
    friction = sum(
        rows[:, k] * estimate.values[k] for k, name in enumerate(estimate.names) if name.startswith(("c0_", "d_"))
    )
    Kp, Kd = np.array([60.0, 40.0, 15.0]), np.array([6.0, 4.0, 1.5])
    return Kp * (qd - q) + Kd * (vd - v) + estimate.leg.gravity(q)[0] + friction
