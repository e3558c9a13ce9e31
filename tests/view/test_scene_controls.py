"""Controls of a scene in a real Chromium: keys, speed, numbers, torque plot, dark scheme, phone, paper."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from browser import distance_to

from exoid.estimate import validate
from exoid.view import scene

READY = "window.exoid !== undefined && window.exoid.viewer.renderer.info.render.frame > 0"
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


def test_a_phone_shows_panels_inside_its_window(browser, url):
    with browser.page(url, (390, 844)) as page:
        page.wait_for(READY)
        page.evaluate("document.querySelector('#legend').open = true")
        click(page, "#show-plot")
        page.screenshot("scene_phone")
        assert page.evaluate("document.documentElement.scrollWidth") <= 390
        for selector in ("#legend", "#player", "#player select", "#plot", "#plot svg"):
            left, right = page.evaluate(
                f"(b => [b.left, b.right])(document.querySelector('{selector}').getBoundingClientRect())"
            )
            assert left >= 0, selector
            assert right <= 390, selector
            assert right > left, selector


def test_a_dark_scheme_has_a_dark_background(browser, url):
    with browser.page(url) as page:
        page.wait_for(READY)
        light = page.screenshot("scene_light")
        page.send("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}])
        page.wait_for("matchMedia('(prefers-color-scheme: dark)').matches")
        dark = page.screenshot("scene_dark")
        page.send("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "light"}])
        page.wait_for("matchMedia('(prefers-color-scheme: light)').matches")
        again = page.screenshot()
    assert np.median(light) > 200
    assert np.median(dark) < 80
    np.testing.assert_array_equal(again, light)


@pytest.mark.parametrize("size", [(800, 600), (390, 844)])
def test_paper_has_the_scene_and_no_controls(browser, url, size):
    with browser.page(url, size) as page:
        page.wait_for(READY)
        page.evaluate("window.dispatchEvent(new Event('beforeprint'))")
        # Whatever the window, whose size is not definite while it is printed.
        still = page.evaluate("(c => [c.width, c.height])(document.querySelector('#still'))")
        page.send("Emulation.setEmulatedMedia", media="print")
        picture = page.screenshot("scene_paper")
        for selector in ("#legend", "#player", "#meshcat-pane"):
            assert page.evaluate(f"document.querySelector('{selector}').offsetHeight") == 0
    assert still == [1600, 800]
    share = 0.5 * size[0] / size[1]  # of the window that the picture covers
    assert (picture.min(axis=-1) < 120).mean() > 0.02 * share
    assert (distance_to(picture, "#ffffff") > 60).mean() < 0.6


def test_the_camera_sees_ellipsoids_that_are_larger_than_the_leg(leg):
    """As those of poor estimates are; the ground stays below the foot."""
    model = leg.model.copy()
    shank = model.inertias[2]
    model.inertias[2] = pin.Inertia(shank.mass, shank.lever, shank.inertia + 8.0 * np.eye(3))
    small, large = scene(leg), scene(replace(leg, model=model))
    moments = np.linalg.eigvalsh(model.inertias[2].inertia)
    longest = np.sqrt(2.5 * (moments.sum() - 2.0 * moments[0]) / shank.mass)
    assert longest > small.camera.half_height
    assert large.camera.half_height > 0.9 * longest
    grounds = [
        np.array(next(c for c in drawn.commands if c["path"] == "/exoid/ground" and "matrix" in c)["matrix"])
        for drawn in (small, large)
    ]
    np.testing.assert_array_equal(*grounds)
