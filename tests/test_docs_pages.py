"""Pages of the docs are true: their Python and their commands run as they stand, and print what the page shows.

test_shown_commands.py makes sure that no command is left out.
"""

from __future__ import annotations

import re

import pytest
from doc_pages import ROOT, Page, own_leg, real_data, without_spaces

DOCS = ROOT / "docs"
TESTED_ELSEWHERE = {
    "extending": "tests/extension/test_extending_page.py",  # it needs an installed package
    "control": "tests/control/test_control_page.py",
    "microcontroller": "tests/codegen/test_microcontroller_page.py",
    "view": "tests/view/test_view_docs.py",
}
"""Pages that need a compiler, minutes, or a look at what they write."""
LONG = (
    "amperes",
    "amplification",
    "commissioning",
    "coordination",
    "figures",
    "friction",
    "gains",
    "ground-rig",
    "index",
    "predicts-poorly",
    "validation",
    "wearer",
)  # more than seven seconds each

ALL = {path.stem: Page.read(f"docs/{path.name}") for path in sorted(DOCS.glob("*.md"))}
PAGES = [name for name, page in ALL.items() if page.python or page.commands]

pytestmark = pytest.mark.skipif(not DOCS.is_dir(), reason="needs the source tree")


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(
            name,
            marks=[
                pytest.mark.nightly if name in LONG else pytest.mark.slow,
                *real_data(ALL[name].python + "".join(ALL[name].commands)),
            ],
        )
        for name in PAGES
        if name not in TESTED_ELSEWHERE
    ],
)
def test_the_page_runs_from_top_to_bottom(name, tmp_path):
    page = ALL[name]
    own_leg(tmp_path)
    printed = without_spaces(page.run(tmp_path))
    assert not [block for block in page.shown if without_spaces(block) not in printed]


def test_every_page_that_has_something_to_run_is_run():
    assert len(PAGES) >= 12
    for name, test in TESTED_ELSEWHERE.items():
        assert name in PAGES
        assert f"docs/{name}.md" in (ROOT / test).read_text(encoding="utf-8")


def test_a_page_that_forgets_an_import_fails(tmp_path):
    page = Page("docs/none.md", "\n\nexoid.load_leg('bleex')\n", (), ())
    with pytest.raises(AssertionError, match=r"docs/none.md.*line 3(.|\n)*NameError"):
        page.run_python(tmp_path)


def test_a_page_with_a_wrong_command_fails(tmp_path):
    page = Page("docs/none.md", "", ("exoid --version", "exoid identify bleex none.csv"), ())
    with pytest.raises(AssertionError, match=r"exoid identify bleex none.csv: exit status 2"):
        page.run_commands(tmp_path)


def test_the_page_of_benchmarks_names_every_benchmark_and_no_other():
    page = (DOCS.parent / "BENCHMARKS.md").read_text(encoding="utf-8")
    named = set(re.findall(r"tests/benchmarks/test_\w+\.py", page))
    assert named == {f"tests/benchmarks/{path.name}" for path in (DOCS.parent / "tests/benchmarks").glob("test_*.py")}
