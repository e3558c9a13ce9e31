"""The page on control is true: its Python runs as it stands."""

import re
from pathlib import Path

import pytest

PAGE = Path(__file__).resolve().parents[2] / "docs" / "control.md"

pytestmark = pytest.mark.skipif(not PAGE.is_file(), reason="needs the source tree")


def test_the_python_of_the_page_runs(capsys):
    blocks = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    assert blocks
    for block in blocks:
        exec(compile(block, str(PAGE), "exec"), {"__name__": "page"})
    assert "GravityFrictionPD at 100 Hz, 2 to 4 s" in capsys.readouterr().out


def test_the_page_names_every_law():
    import exoid  # noqa: PLC0415

    text = PAGE.read_text(encoding="utf-8")
    for name in exoid.control.__all__:
        assert f"`{name}" in text or f"{name}(" in text, name
