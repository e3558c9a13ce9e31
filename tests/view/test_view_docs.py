"""docs/view.md is true: its commands and its Python run as they stand."""

import pytest
from doc_pages import Page, run

PAGE = Page.read("docs/view.md")

pytestmark = pytest.mark.skipif(not PAGE.python, reason="needs the source tree")


@pytest.mark.nightly
def test_commands_and_python_run_and_write_pages_of_the_size_that_is_said(tmp_path):
    assert len(PAGE.commands) == 5
    for part in ({"commands": PAGE.commands}, {"python": PAGE.python}):
        run(tmp_path, **part)
        assert (tmp_path / "replay.html").stat().st_size < 0.45e6
    assert 0.25e6 < (tmp_path / "leg.html").stat().st_size < 0.35e6
