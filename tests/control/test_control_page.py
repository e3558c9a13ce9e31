"""The page on control is true: its Python runs as it stands."""

import pytest
from doc_pages import ROOT, Page

import exoid

PAGE = Page.read("docs/control.md")

pytestmark = pytest.mark.skipif(not PAGE.python, reason="needs the source tree")


@pytest.mark.slow
def test_the_python_of_the_page_runs(tmp_path):
    assert "GravityFrictionPD at 100 Hz, 2 to 4 s" in PAGE.run_python(tmp_path)
    assert not PAGE.commands


def test_the_pages_name_every_law():
    pages = (ROOT / PAGE.name, *(ROOT / "docs" / f"{name}.md" for name in ("stance-control", "coordination")))
    text = "".join(page.read_text(encoding="utf-8") for page in pages)
    for name in exoid.control.__all__:
        assert f"`{name}" in text or f"{name}(" in text, name
