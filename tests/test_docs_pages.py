"""Pages of the docs are true: their Python and their commands run as they stand, and print what the page shows."""

from __future__ import annotations

import re
import shlex
import sys
from pathlib import Path

import pytest

from exoid.cli import main

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGES = ("any-robot", "large-data", "logs", "plan", "several-legs")

pytestmark = pytest.mark.skipif(not DOCS.is_dir(), reason="needs the source tree")


@pytest.mark.parametrize("page", PAGES)
def test_the_page_runs_from_top_to_bottom(page, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    text = (DOCS / f"{page}.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```(\w+)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    names: dict[str, object] = {"__name__": page}
    for language, block in blocks:
        if language == "python":
            exec(compile(block, page, "exec"), names)
        for command in block.splitlines() if language == "bash" else ():
            monkeypatch.setattr(sys, "argv", shlex.split(command))
            with pytest.raises(SystemExit) as stop:
                main()
            assert not stop.value.code, command
    printed = " ".join(capsys.readouterr().out.split())
    shown = [" ".join(block.split()) for language, block in blocks if language == "text"]
    assert all(block in printed for block in shown)
    assert {"python", "bash"} <= {language for language, _ in blocks}


def test_the_page_of_benchmarks_names_every_benchmark_and_no_other():
    page = (DOCS.parent / "BENCHMARKS.md").read_text(encoding="utf-8")
    named = set(re.findall(r"tests/benchmarks/test_\w+\.py", page))
    assert named == {f"tests/benchmarks/{path.name}" for path in (DOCS.parent / "tests/benchmarks").glob("test_*.py")}
