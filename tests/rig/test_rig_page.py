"""The page on the rig is true: its Python runs as it stands, in a fresh interpreter, and prints what the page shows."""

import pytest
from doc_pages import Page, without_spaces

PAGE = Page.read("docs/rig.md")


@pytest.mark.slow
@pytest.mark.skipif(not PAGE.python, reason="needs the source tree")
def test_the_page_prints_what_it_shows(tmp_path):
    (shown,) = PAGE.shown
    table, _ = shown.rsplit("energy balance", 1)  # the last digit of a rounding error depends on the processor
    assert without_spaces(table) in without_spaces(PAGE.run_python(tmp_path))
    assert not PAGE.commands
