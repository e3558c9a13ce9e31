"""Links of all pages lead to files and headings that exist, and every page is linked."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGES = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/*.md")])
LINK = re.compile(r"\]\((?!https?:)([^)#\s]*)(?:#([^)]*))?\)")

pytestmark = pytest.mark.skipif(not (ROOT / "docs").is_dir(), reason="needs the source tree")


def text_of(page):
    """A page without its code."""
    return re.sub(r"^```.*?^```$|`[^`\n]*`", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)


def links_of(page):
    """Pages and headings that a page links to."""
    return [
        (page if not path else (page.parent / path).resolve(), anchor) for path, anchor in LINK.findall(text_of(page))
    ]


def headings_of(page):
    """Headings of a page, as links call them."""
    headings = re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8").lower(), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading).replace(" ", "-") for heading in headings}


def test_links_lead_somewhere():
    for page in PAGES:
        for target, anchor in links_of(page):
            assert target.exists(), f"{page.name}: {target}"
            assert not anchor or anchor in headings_of(target), f"{page.name}: {target}#{anchor}"


def test_tests_that_a_page_or_script_names_exist():
    for page in [*PAGES, *ROOT.glob("scripts/*.*")]:
        for name in re.findall(r"tests/[\w/]+\.py", page.read_text(encoding="utf-8")):
            assert (ROOT / name).is_file() or page.name == "CHANGELOG.md", f"{page.name}: {name}"


def test_every_page_of_the_docs_is_linked_from_contributing_and_readme_has_the_glossary():
    from_contributing = {target for target, _ in links_of(ROOT / "CONTRIBUTING.md")}
    assert {page for page in PAGES if page.parent == ROOT / "docs"} <= from_contributing
    from_readme = {target.name for target, _ in links_of(ROOT / "README.md")}
    assert {"glossary.md", "references.md", "architecture.md", "CONTRIBUTING.md"} <= from_readme
