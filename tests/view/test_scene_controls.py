"""Controls of a scene in a real Chromium: keys, speed, numbers, torque plot, dark scheme, phone, paper."""

import numpy as np
import pytest
from browser import READY

from exoid.estimate import validate
from exoid.view import scene

TIME = "window.exoid.viewer.animator.time"
START = 2.5

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def url(tmp_path_factory, data, estimate):
    file = tmp_path_factory.mktemp("scene") / "replay.html"
    scene(estimate, recording=data.test).save(file)
    return f"{file.as_uri()}#t={START}"


def press(page, key, shift=False):
    """Press a key, as a user of the page does."""
    codes = {" ": 32, "ArrowLeft": 37, "ArrowRight": 39, "Home": 36, "End": 35}
    event = {"key": key, "windowsVirtualKeyCode": codes[key], "modifiers": 8 * shift}
    page.send("Input.dispatchKeyEvent", type="keyDown", **event)
    page.send("Input.dispatchKeyEvent", type="keyUp", **event)


def click(page, selector):
    page.evaluate(f"document.querySelector('{selector}').click()")


def text(page, selector):
    return page.evaluate(f"document.querySelector('{selector}').innerText")


def test_keys_step_and_play(browser, url):
    with browser.page(url) as page:
        page.wait_for(READY)
        for key, shift, expected in (
            ("ArrowRight", False, START + 1 / 30),
            ("ArrowRight", True, START + 1 / 30 + 1.0),
            ("ArrowLeft", True, START + 1 / 30),
            ("ArrowLeft", False, START),
            ("Home", False, 0.0),
            ("ArrowLeft", False, 0.0),
        ):
            press(page, key, shift)
            assert page.evaluate(TIME) == pytest.approx(expected, abs=1e-6), key
        press(page, " ")
        page.wait_for(f"{TIME} > 0.05")
        press(page, " ")
        assert not page.evaluate("window.exoid.viewer.animator.playing")
        page.evaluate("document.querySelector('#player input').focus()")  # keys do the same from the slider
        before = page.evaluate(TIME)
        press(page, "ArrowRight")
        assert page.evaluate(TIME) == pytest.approx(before + 1 / 30, abs=1e-6)
        assert page.problems == []


def test_buttons_and_lists_act_by_themselves(browser, url):
    with browser.page(url, (1280, 800)) as page:
        page.wait_for(READY)
        page.evaluate("document.querySelector('#show-names').focus()")
        press(page, " ")
        assert not page.evaluate("window.exoid.viewer.animator.playing")
        script = "(s => { s.value = '0.25'; s.dispatchEvent(new Event('change')); })"
        page.evaluate(f"{script}(document.querySelector('#player select'))")
        assert page.evaluate("window.exoid.viewer.animator.mixer.timeScale") == 0.25
        display = "getComputedStyle(document.querySelector('.dg.main')).display"
        assert page.evaluate(display) == "none"
        click(page, "#show-viewer")
        assert page.evaluate(display) == "block"
        weights, torques = page.evaluate("[...document.querySelectorAll('#layers small')].map(s => s.textContent)")
        assert weights.startswith("arrow of")
        assert weights.endswith(" N")
        assert "N·m" in torques
        heights = page.evaluate("[...document.querySelectorAll('#legend label')].map(l => l.offsetHeight)")
        assert min(heights) >= 24  # far enough apart for a finger


def test_names_and_numbers_are_those_of_the_recording(browser, url, data):
    with browser.page(url) as page:
        page.wait_for(READY)
        assert page.evaluate("document.querySelector('#names').hidden")
        click(page, "#show-names")
        page.screenshot()
        lines = text(page, "#names span:nth-child(2)").split("\n")
    angle = np.rad2deg(np.interp(START, data.test.time, data.test.q[:, 1]))
    torque = np.interp(START, data.test.time, data.test.tau[:, 1])
    assert lines[0] == "left_knee"
    assert lines[1] == f"{angle:.1f} °".replace("-", "−")
    assert lines[2] == f"{torque:.1f} N·m".replace("-", "−")


def test_the_torque_plot_follows_the_playback(browser, url, data, estimate):
    with browser.page(url, (1280, 800)) as page:
        page.wait_for(READY)
        page.screenshot("scene_plot")
        assert page.evaluate("document.querySelectorAll('#plot figure').length") == 3
        now = "Number(document.querySelector('#plot .now').getAttribute('x1'))"
        assert page.evaluate(now) == pytest.approx(START)
        shown = text(page, "#plot figcaption span:nth-child(2)")
        press(page, "ArrowRight", shift=True)
        page.screenshot()
        assert page.evaluate(now) == pytest.approx(START + 1.0)
        measured = np.interp(START, data.test.time, data.test.tau[:, 0])
        found = validate(estimate, data.test)
        predicted = np.interp(START, found.time, found.predicted[:, 0])
        assert shown == f"{measured:.1f} / {predicted:.1f} N·m"
        box = page.evaluate(
            "(b => [b.left, b.top, b.width])(document.querySelector('#plot svg').getBoundingClientRect())"
        )
        for kind in ("mousePressed", "mouseReleased"):
            page.send(
                "Input.dispatchMouseEvent",
                type=kind,
                x=box[0] + 0.5 * box[2],
                y=box[1] + 20,
                button="left",
                clickCount=1,
            )
        assert page.evaluate(TIME) == pytest.approx(0.5 * data.test.duration, abs=0.1)
