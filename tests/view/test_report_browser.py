"""The report of an identification in a real Chromium: on a screen, and on a phone."""

import time

import pytest
from browser import distance_to

import exoid
from exoid.view.colours import CAD, IDENTIFIED
from exoid.view.report import identification_report

WIDE, PHONE = (1100, 900), (390, 844)

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def url(tmp_path_factory, data):
    estimate = exoid.identify(data.leg, [data.train.slice(0, 1500), data.train.slice(1500, 3000)])
    file = tmp_path_factory.mktemp("report") / "report.html"
    identification_report(estimate, [data.train.slice(0, 1500), data.train.slice(1500, 3000)], [data.test]).save(file)
    return file.as_uri()


def frame(page):
    """Where the scene is in the window: top, bottom, left and right [pixels]."""
    page.evaluate("document.querySelector('iframe').scrollIntoView({block: 'center'})")
    box = page.evaluate(
        "(b => [b.top, b.bottom, b.left, b.right])(document.querySelector('iframe').getBoundingClientRect())"
    )
    return [round(edge) for edge in box]


def scene_picture(page, name):
    """The scene's part of a screenshot, once the leg is drawn."""
    top, bottom, left, right = frame(page)
    until = time.monotonic() + 60.0
    while True:
        seen = page.screenshot(name)[max(top, 0) : bottom, left:right]
        if (seen.min(axis=-1) < 120).mean() > 0.02 or time.monotonic() > until:
            return seen


@pytest.mark.parametrize(("size", "name"), [(WIDE, "report_wide"), (PHONE, "report_phone")])
def test_the_report_shows_its_scene_and_requests_nothing(browser, url, size, name):
    with browser.page(url, size) as page:
        page.wait_for("[...document.images].every(i => i.complete && i.naturalWidth > 0)")
        page.screenshot(f"{name}_top")
        seen = scene_picture(page, f"{name}_scene")
        for colour in (CAD, IDENTIFIED):
            assert (distance_to(seen, colour) < 60).sum() > 20, colour
        assert page.problems == []
        assert page.requests == [url]


@pytest.mark.parametrize("width", [320, 390, 700, 1100])
def test_the_page_fits_windows_of_any_width(browser, url, width):
    """Wide tables scroll by themselves; the page does not scroll sideways."""
    with browser.page(url, (width, 844)) as page:
        page.wait_for("[...document.images].every(i => i.complete && i.naturalWidth > 0)")
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert page.evaluate("document.documentElement.clientWidth") == width
