"""The page on logs is true: its Python and its command run as they stand."""

from __future__ import annotations

import re
import shlex
import sys
from pathlib import Path

import pytest

from exoid.cli import main

PAGE = Path(__file__).resolve().parents[1] / "docs" / "logs.md"
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", PAGE.read_text(encoding="utf-8") if PAGE.is_file() else "", re.M | re.S)


@pytest.mark.skipif(not BLOCKS, reason="needs the source tree")
def test_the_page_on_logs_runs_from_top_to_bottom(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert [language for language, _ in BLOCKS] == ["python", "bash"]
    exec(compile(BLOCKS[0][1], str(PAGE), "exec"), {"__name__": "logs"})
    assert "joints: left_knee; q, tau" in capsys.readouterr().out
    monkeypatch.setattr(sys, "argv", shlex.split(BLOCKS[1][1]))
    with pytest.raises(SystemExit) as stop:
        main()
    assert not stop.value.code
    assert (tmp_path / "leg.json").is_file()
