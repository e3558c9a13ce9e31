"""Pages of the docs as a browser shows them: no table, heading or terminal output that Markdown left as it was."""

import re

import pytest
from doc_pages import ROOT

DOCS = ROOT / "docs"
PAGES = [*sorted(DOCS.rglob("*.md")), ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "BENCHMARKS.md"]
EXTENSIONS = ("admonition", "attr_list", "md_in_html", "tables", "pymdownx.highlight", "pymdownx.superfences", "toc")
"""Those of mkdocs.yml that decide what is a block."""

CODE = re.compile(r"<(pre|code)\b.*?</\1>", re.DOTALL)
LEFT = {
    "table": re.compile(r"^\s*\|\s.*|^.*\|-{2,}.*", re.MULTILINE),
    "heading": re.compile(r"^#{1,4} .*", re.MULTILINE),
    "list": re.compile(r"^ ?\* .*", re.MULTILINE),
    "terminal rule": re.compile(r".*──.*"),
    "fence": re.compile(r".*```.*"),
}
"""What must not be seen in text."""

pytestmark = pytest.mark.skipif(not DOCS.is_dir(), reason="needs the source tree")
markdown = pytest.importorskip("markdown", reason="needs the extra docs")
pytest.importorskip("pymdownx", reason="needs the extra docs")


def left_over(text):
    """Lines of a page that Markdown did not understand, with their kind."""
    seen = re.sub(r"<[^>]+>", "", CODE.sub("", markdown.markdown(text, extensions=EXTENSIONS)))
    return [(kind, found[0]) for kind, pattern in LEFT.items() for found in pattern.finditer(seen)]


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_every_block_of_a_page_is_understood(path):
    assert left_over(path.read_text(encoding="utf-8")) == []
