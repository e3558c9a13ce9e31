"""Replays as pages say what the printed tables say, with the documents' figures."""

import pytest
from html_pages import check

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(("document", "pictures"), [("bleex", 5), ("cuhk", 2)])
def test_the_page_is_valid_and_has_every_figure(document, pictures, request):
    tree = check(request.getfixturevalue(document)["page"])
    assert len(list(tree.iter("img"))) == pictures
    assert f"document {1 if document == 'bleex' else 2} replayed" in tree.findtext(".//h1")


@pytest.mark.parametrize("document", ["bleex", "cuhk"])
def test_every_number_of_the_printed_tables_is_on_the_page(document, request):
    replay = request.getfixturevalue(document)
    tree = check(replay["page"])
    words = " ".join(replay["text"].split())
    for cell in [*tree.iter("td"), *tree.iter("th")]:
        assert (cell.text or "") in words
    for item in tree.iter("li"):
        assert item.text in words
