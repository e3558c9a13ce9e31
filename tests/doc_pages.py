"""Pages of Markdown whose Python and whose commands run as they stand, in a fresh interpreter or in this one."""

from __future__ import annotations

import io
import json
import os
import re
import sys
import webbrowser
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import processes
import pytest

import exoid
from exoid.view.scenes.server import SceneServer

ROOT = Path(__file__).resolve().parents[1]
FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)

SHELL = ("bash", "console")
"""Languages of blocks of commands."""

PROGRAM = """
import json, shlex, sys

python, commands = json.load(sys.stdin)
exec(compile(python, sys.argv[1], "exec"), {"__name__": "__main__"})
for line in commands:
    from exoid.cli import main

    sys.argv = shlex.split(line, comments=True)
    if sys.argv[1] == "view":  # there is no browser to open, and no one to press Ctrl-C
        import webbrowser

        from exoid.view.scenes.server import SceneServer

        webbrowser.open, SceneServer.wait = lambda url: True, lambda server: None
    try:
        main()
    except SystemExit as stop:
        if stop.code:
            sys.exit(f"{line}: exit status {stop.code}")
"""


class Page(NamedTuple):
    """A page of Markdown.

    Attributes:
        name: From the root of the project.
        python: All its Python, each line at the place that it has on the page.
        commands: Lines of its shell that start with exoid, also behind ``&&``.
        shown: Blocks of printed text.
    """

    name: str
    python: str
    commands: tuple[str, ...]
    shown: tuple[str, ...]

    @staticmethod
    def read(name: str) -> Page:
        """Read a page; one that does not exist has nothing on it."""
        path = ROOT / name
        text = path.read_text(encoding="utf-8") if path.is_file() else ""
        python = ""
        commands, shown = [], []
        for block in FENCE.finditer(text):
            language, content = block.groups()
            if language == "python":
                lines_above = text.count("\n", 0, block.start(2))
                python += "\n" * (lines_above - python.count("\n")) + content
            if language in SHELL:
                commands += exoid_commands(content)
            if language == "text":
                shown.append(content)
        return Page(name, python, tuple(commands), tuple(shown))

    def run(self, folder: Path) -> str:
        """Run its Python, and then its commands in the same interpreter; return what they printed."""
        return run(folder, self.python, self.commands, self.name)

    def run_here(self, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> str:
        """Run the same in this process, without seconds of imports: a page that forgets one may pass."""
        monkeypatch.chdir(folder)
        monkeypatch.setattr(sys, "argv", ["-c", self.name])
        monkeypatch.setattr(sys, "stdin", io.StringIO(json.dumps([self.python, self.commands])))
        monkeypatch.setattr(webbrowser, "open", webbrowser.open)  # both are put back afterwards
        monkeypatch.setattr(SceneServer, "wait", SceneServer.wait)
        exec(PROGRAM, {"__name__": "__main__"})
        return capsys.readouterr().out


def shell_commands(block: str) -> list[str]:
    """Commands of a block, those after ``&&`` included, without prompts and comments."""
    lines = [line.removeprefix("$ ").partition(" #")[0] for line in block.splitlines() if not line.startswith("#")]
    parts = [part.strip() for line in lines for part in line.split("&&")]
    return [part for part in parts if part]


def real_data(text: str) -> list[pytest.MarkDecorator]:
    """Marks of the datasets that a page or a block names."""
    names = ("dfki_double_pendulum", "sydney_swing_leg", "teststand_leg")
    return [pytest.mark.real_data(name) for name in names if name in text]


def exoid_commands(block: str) -> list[str]:
    """Commands of a block that start with exoid, those after ``&&`` included."""
    return [part for part in shell_commands(block) if part.startswith("exoid ")]


def run(folder: Path, python: str = "", commands: tuple[str, ...] | list[str] = (), name: str = "") -> str:
    """Run Python and commands in one fresh interpreter; return what they printed."""
    # readline, which pytest imports, puts COLUMNS behind Python's back into what a child inherits
    env = dict(os.environ)
    return processes.run_python(PROGRAM, name, input=json.dumps([python, commands]), cwd=folder, env=env)


def own_leg(folder: Path) -> None:
    """Write ``my_leg.urdf`` and ``log.csv`` to a folder: what a page on one's own leg assumes its reader to have."""
    urdf = (exoid.catalog.urdf_folder() / "bleex.urdf").read_text(encoding="utf-8")
    (folder / "my_leg.urdf").write_text(urdf.replace("left_hip", "hip").replace("left_knee", "knee"), encoding="utf-8")
    log = exoid.datasets.bleex_swing().train.select(("left_hip", "left_knee"))
    replace(log, joint_names=("hip", "knee")).to_csv(folder / "log.csv")


def without_spaces(text: str) -> str:
    """Text as it reads, whatever its lines and columns."""
    return " ".join(text.split())
