"""The page on the rig is true: its Python runs as it stands and prints what the page shows."""

import re
from pathlib import Path

import pytest

PAGE = Path(__file__).resolve().parents[2] / "docs" / "rig.md"


@pytest.mark.slow
@pytest.mark.skipif(not PAGE.is_file(), reason="needs the source tree")
def test_the_page_prints_what_it_shows(capsys):
    text = PAGE.read_text(encoding="utf-8")
    program, _ = re.findall(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    (shown,) = re.findall(r"^```text\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    names: dict[str, object] = {}
    exec(compile(program, PAGE.name, "exec"), names)
    table, _ = shown.rsplit("energy balance", 1)  # the last digit of a rounding error depends on the processor
    assert table.split() == capsys.readouterr().out.split()[: len(table.split())]
    assert len(names["log"]) == 501
