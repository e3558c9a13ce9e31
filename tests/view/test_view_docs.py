"""docs/view.md is true: its commands and its Python run as they stand."""

import pytest
from doc_pages import Page

PAGE = Page.read("docs/view.md")

pytestmark = pytest.mark.skipif(not PAGE.python, reason="needs the source tree")


@pytest.mark.nightly
def test_the_commands_run_and_write_pages_of_the_size_that_is_said(tmp_path):
    assert len(PAGE.commands) == 5
    PAGE.run_commands(tmp_path)
    assert 0.25e6 < (tmp_path / "leg.html").stat().st_size < 0.35e6
    assert (tmp_path / "replay.html").stat().st_size < 0.45e6


@pytest.mark.nightly
def test_the_python_runs(tmp_path):
    PAGE.run_python(tmp_path)
    assert (tmp_path / "replay.html").stat().st_size < 0.45e6
