"""Pages of the docs are true: their Python and their commands run as they stand, and print what the page shows.

Every page runs at night in an interpreter of its own, which has imported nothing; short ones also with the slow tests.
"""

import re

import pytest
from doc_pages import ROOT, Page, own_leg, real_data, without_spaces

import exoid

DOCS = ROOT / "docs"
TESTED_ELSEWHERE = {
    "extending": "tests/extension/test_extending_page.py",  # it needs an installed package
    "microcontroller": "tests/codegen/test_microcontroller_page.py",
    "view": "tests/view/test_view_docs.py",
}
"""Pages that need a compiler, minutes, or a look at what they write."""
LONG = (
    *("amperes", "amplification", "commissioning", "coordination", "figures"),
    *("friction", "gains", "ground-rig", "index", "predicts-poorly", "validation"),
    *("wearer",),
)

CONTROL = ("control", "stance-control", "coordination")

ALL = {path.stem: Page.read(f"docs/{path.name}") for path in sorted(DOCS.glob("*.md"))}
PAGES = [name for name, page in ALL.items() if page.python or page.commands]

pytestmark = pytest.mark.skipif(not DOCS.is_dir(), reason="needs the source tree")


RUN = {
    name: real_data(page.python + "".join(page.commands))
    for name, page in ALL.items()
    if name in PAGES and name not in TESTED_ELSEWHERE
}
"""Pages that are run, with the marks of their data."""


@pytest.mark.slow
@pytest.mark.usefixtures("forgetful")
@pytest.mark.parametrize("name", [pytest.param(name, marks=RUN[name]) for name in RUN if name not in LONG])
def test_the_page_runs_in_this_process(name, tmp_path, monkeypatch, capsys):
    own_leg(tmp_path)
    _shows_what_it_prints(ALL[name], ALL[name].run_here(tmp_path, monkeypatch, capsys))


@pytest.mark.nightly
@pytest.mark.parametrize("name", [pytest.param(name, marks=RUN[name]) for name in RUN])
def test_the_page_runs_from_top_to_bottom(name, tmp_path):
    own_leg(tmp_path)
    _shows_what_it_prints(ALL[name], ALL[name].run(tmp_path))


def _shows_what_it_prints(page, printed):
    """Every block of printed text on the page was printed."""
    assert not [block for block in page.shown if without_spaces(block) not in without_spaces(printed)]


def test_every_page_that_has_something_to_run_is_run():
    assert len(PAGES) >= 12
    for name, test in TESTED_ELSEWHERE.items():
        assert name in PAGES
        assert f"docs/{name}.md" in (ROOT / test).read_text(encoding="utf-8")


def test_the_pages_on_control_name_every_law():
    text = "".join((DOCS / f"{name}.md").read_text(encoding="utf-8") for name in CONTROL)
    for name in exoid.control.__all__:
        assert f"`{name}" in text or f"{name}(" in text, name


def test_the_page_of_benchmarks_names_every_benchmark_and_no_other():
    page = (DOCS.parent / "BENCHMARKS.md").read_text(encoding="utf-8")
    named = set(re.findall(r"tests/benchmarks/test_\w+\.py", page))
    assert named == {f"tests/benchmarks/{path.name}" for path in (DOCS.parent / "tests/benchmarks").glob("test_*.py")}
