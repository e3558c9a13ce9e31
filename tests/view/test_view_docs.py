"""docs/view.md is true: its commands and its Python run as they stand, and its table is what the study prints."""

from __future__ import annotations

import re
import runpy
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from exoid.cli import main
from exoid.view import SceneServer

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "view.md"
BLOCKS = (
    re.findall(r"^```(\w+)\n(.*?)^```$", PAGE.read_text("utf-8"), re.MULTILINE | re.DOTALL) if PAGE.is_file() else []
)

PYTHON = [text for language, text in BLOCKS if language == "python"]

pytestmark = pytest.mark.skipif(not BLOCKS, reason="needs the source tree")


@pytest.fixture(autouse=True)
def unattended(tmp_path, monkeypatch):
    """In an empty folder, with no browser to open and no one to press Ctrl-C."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("webbrowser.open", lambda url: True)
    monkeypatch.setattr(SceneServer, "wait", lambda self: None)


def test_the_commands_run_and_write_pages_of_the_size_that_the_page_states(monkeypatch):
    (commands,) = [text for language, text in BLOCKS if language == "bash"]
    for command in commands.splitlines():
        monkeypatch.setattr(sys, "argv", shlex.split(command, comments=True))
        with pytest.raises(SystemExit) as stop:
            main()
        assert not stop.value.code, command
    assert 0.25e6 < Path("leg.html").stat().st_size < 0.35e6
    assert Path("replay.html").stat().st_size < 0.45e6


@pytest.mark.parametrize("block", PYTHON, ids=range(len(PYTHON)))
def test_each_python_block_runs_in_a_fresh_interpreter(tmp_path, block):
    subprocess.run([sys.executable, "-c", block], check=True, capture_output=True, cwd=tmp_path)
    pages = [page.stat().st_size for page in tmp_path.glob("*.html")]
    assert all(size < 0.45e6 for size in pages)
    assert len(pages) == block.count(".save(")


@pytest.mark.slow
@pytest.mark.real_data
def test_the_table_is_what_the_study_prints(capsys):
    try:
        runpy.run_path(str(ROOT / "scripts" / "study_prediction.py"), run_name="__main__")
    except Exception as error:
        if "cannot be downloaded" in str(error):
            pytest.skip("the DFKI recording is neither in $EXOID_DATA_DIR nor to be downloaded: see tests/datasets")
        raise
    assert capsys.readouterr().out in PAGE.read_text("utf-8")
