"""What a page of HTML must be, whatever it tells: read by a parser that forgives nothing."""

import itertools
import re
from contextlib import contextmanager

import html5lib
import pytest

from exoid.view.report.page import Picture
from exoid.view.scenes import Scene

HEADINGS = ("h1", "h2", "h3", "h4")


@contextmanager
def undrawn():
    """Reports without drawings and scenes, which take most of the time: for tests of their words."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Picture, "svg", b"")
        patch.setattr(Scene, "html", lambda _: "<!DOCTYPE html><title>scene</title>")
        yield


def check(html, largest=5e6):
    """One title, headings in order, words for every picture, nothing from outside, and not too large."""
    tree = html5lib.HTMLParser(strict=True, namespaceHTMLElements=False).parse(html)  # raises on a misplaced tag
    assert len(html.encode()) < largest
    assert tree.get("lang") == "en"
    assert tree.findtext(".//title")
    levels = [HEADINGS.index(e.tag) for e in tree.iter() if e.tag in HEADINGS]
    assert levels[0] == 0
    assert levels.count(0) == 1
    assert all(after <= before + 1 for before, after in itertools.pairwise(levels))
    for image in tree.iter("img"):
        assert image.get("alt", "").strip()
        assert image.get("src").startswith("data:")
    for frame in tree.iter("iframe"):
        assert frame.get("title", "").strip()
    assert not re.search(r"(?:src|href)=[\"']?(?:https?:)?//", html)
    for table in tree.iter("table"):
        widths = {len(list(row)) for row in table.iter("tr")}
        assert len(widths) == 1, "every row has as many cells as the header"
    return tree
