"""Markdown becomes the page that was meant: tables are tables, and rules of a terminal stand in blocks of code."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

markdown = pytest.importorskip("markdown", reason="comes with pip install '.[docs]'")

ROOT = Path(__file__).resolve().parents[1]
PAGES = [
    *sorted((ROOT / "docs").rglob("*.md")),
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "BENCHMARKS.md")),
]
EXTENSIONS = ("tables", "fenced_code", "attr_list", "admonition", "toc")

pytestmark = pytest.mark.skipif(not (ROOT / "docs").is_dir(), reason="needs the source tree")


def faults(text):
    """What of a page's text is no page: rules and rows of tables in paragraphs, rules of a terminal outside of code."""
    html = markdown.markdown(text, extensions=list(EXTENSIONS))
    prose = re.sub(r"<(pre|code)\b.*?</\1>", "", html, flags=re.DOTALL)
    found = re.findall(r"\|\s*:?-{3,}.*|─{3,}.*", prose)
    for paragraph in re.findall(r"<(?:p|li|h\d)\b[^>]*>(.*?)</(?:p|li|h\d)>", prose, flags=re.DOTALL):
        found += [line for line in paragraph.splitlines() if line.lstrip().startswith("|") or "```" in line]
    for row in re.findall(r"<td[^>]*>(.*?)</td>", prose, flags=re.DOTALL):
        found += [row] if "```" in row or row.lstrip().startswith("#") else []
    return found


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_a_page_has_no_raw_tables_and_nothing_is_glued_to_one(page):
    assert faults(page.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize(
    "text",
    [
        "words\n| a | b |\n|---|---|\n| 1 | 2 |\nmore",
        "| a | b |\n|---|---|\n| 1 | ─────── |",
        "a list\n* one\n\n| a | b |\n| 1 | 2 |",
    ],
)
def test_what_was_wrong_once_is_found(text):
    assert faults(text)


def test_a_table_and_the_output_of_a_terminal_are_no_faults():
    assert faults("words\n\n| a | b |\n|---|---|\n| 1 | 2 |\n\n```text\n joint  x\n ────────\n```\n") == []
