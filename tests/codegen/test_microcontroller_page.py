"""The page on microcontrollers does what it says: its commands, its program and its output."""

import re
from pathlib import Path

import numpy as np
import processes
import pytest
from compiled import compile_c, needs_compiler
from doc_pages import FENCE, ROOT, Page, run

import exoid

PAGE = Page.read("docs/microcontroller.md")

pytestmark = [needs_compiler, pytest.mark.skipif(not PAGE.commands, reason="needs the source tree")]


@pytest.mark.slow
def test_the_commands_and_the_program_print_what_the_page_shows(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blocks = FENCE.findall((ROOT / PAGE.name).read_text(encoding="utf-8"))
    programs, shown = ([text for language, text in blocks if language == kind] for kind in ("c", "text"))
    shown = [text for text in shown if not text.startswith("flash")]  # test_stm32_example.py has this block
    builds = [text for language, text in blocks if language == "bash" and text.startswith("cc ")]
    run(tmp_path, commands=PAGE.commands)
    for program, build, output, source in zip(programs, builds, shown, ("leg.c", "law.c"), strict=True):
        Path("main.c").write_text(program, encoding="utf-8")
        assert processes.run("sh", "-c", f"({build}) 2>&1") == output
        compile_c((), Path("main.c"), Path(source), to=Path("strict"))
    printed = [float(value) for value in re.findall(r": (\S+) N m", shown[0])]
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
