"""Scenes in a real Chromium: drawn by WebGL, without an error, without a network request."""

import json

import numpy as np
import pytest
from browser import READY, distance_to

import exoid
from exoid.view import scene
from exoid.view.colours import CAD, IDENTIFIED, JOINT_COLOURS

LEGEND = 260
"""Pixels from the left that the legend may cover."""


def assert_leg_is_drawn(picture, *colours):
    """The background is light; what stands before it is dark or coloured, in the middle and of the size of a leg."""
    inside = picture[:, LEGEND:]
    drawn = inside.min(axis=-1) < 120
    assert 0.02 < drawn.mean() < 0.6
    rows, columns = np.nonzero(drawn)
    assert np.ptp(rows) > 0.5 * inside.shape[0]
    assert abs(columns.mean() - 0.5 * inside.shape[1] + 0.5 * LEGEND) < 0.2 * inside.shape[1]
    for colour in colours:
        assert np.count_nonzero(distance_to(inside, colour) < 40) > 100, colour


def assert_quiet(page, url):
    assert page.problems == []
    assert page.requests == [url]


def switch(page, label):
    """Click the legend's box of a layer."""
    page.evaluate(
        "[...document.querySelectorAll('#legend label')]"
        f".find(l => l.textContent === {json.dumps(label)}).querySelector('input').click()"
    )


@pytest.mark.slow
def test_both_legs_in_a_file_without_a_network(browser, tmp_path):
    legs = [exoid.load_leg("bleex", side) for side in ("left", "right")]
    drawn = scene(*legs, pose={"left_hip": 0.4, "left_knee": -0.7, "right_hip": -0.2, "right_knee": -0.3})
    drawn.save(tmp_path / "leg.html")
    url = (tmp_path / "leg.html").as_uri()
    with browser.page(url) as page:
        page.wait_for(READY)
        picture = page.screenshot("bleex_both")
        assert_leg_is_drawn(picture, CAD, JOINT_COLOURS[0])
        assert_quiet(page, url)
        assert page.evaluate("document.title") == "bleex, left leg, right leg"


@pytest.mark.slow
def test_layers_can_be_switched_off_and_on(browser, tmp_path, estimate):
    scene(estimate).save(tmp_path / "leg.html")
    with browser.page((tmp_path / "leg.html").as_uri()) as page:
        page.wait_for(READY)
        before = page.screenshot("bleex_estimate")[:, LEGEND:]
        assert np.count_nonzero(distance_to(before, IDENTIFIED) < 40) > 20
        for label in ("centres of mass", "identified inertia", "CAD inertia"):
            switch(page, label)
        without = page.screenshot()[:, LEGEND:]
        assert np.count_nonzero(distance_to(without, IDENTIFIED) < 40) == 0
        for label in ("centres of mass", "identified inertia", "CAD inertia"):
            switch(page, label)
        np.testing.assert_array_equal(page.screenshot()[:, LEGEND:], before)


@pytest.mark.slow
def test_a_replay_plays_in_real_time_and_follows_the_slider(browser, tmp_path, data, estimate):
    scene(estimate, recording=data.test).save(tmp_path / "leg.html")
    url = (tmp_path / "leg.html").as_uri()
    with browser.page(url) as page:
        page.wait_for(READY)
        page.wait_for("window.exoid.viewer.animator.time > 0")  # it plays by itself
        animator = page.evaluate("(a => [a.duration, a.mixer.timeScale])(window.exoid.viewer.animator)")
        assert animator == pytest.approx([data.test.duration, 1.0], abs=1.0 / 30.0)  # in real time
        page.evaluate("document.querySelector('#player button').click()")
        stopped = page.evaluate("window.exoid.viewer.animator.playing")
        pictures = [scrubbed(page, time) for time in (1.0, 2.4, 1.0)]
        np.testing.assert_array_equal(pictures[0], pictures[2])
        moved = np.abs(pictures[0].astype(int) - pictures[1]).max(axis=-1) > 30
        assert moved[:, LEGEND:].mean() > 0.01
        assert_leg_is_drawn(page.screenshot("bleex_replay"))
        assert not stopped
        assert_quiet(page, url)
        knee = page.evaluate(
            "window.exoid.viewer.scene_tree.find(['exoid', 'left leg', 'left_hip', 'body', 'left_knee', 'body'])"
            ".object.quaternion.toArray()"
        )
    angle = 2.0 * np.arctan2(-knee[1], knee[3])  # flexion is positive about −y
    assert angle == pytest.approx(np.interp(1.0, data.test.time, data.test.q[:, 1]), abs=1e-3)


def scrubbed(page, time):
    """Drag the slider to a time and look."""
    page.evaluate(
        f"(() => {{ const s = document.querySelector('#player input'); s.value = {time};"
        " s.dispatchEvent(new Event('input')); })()"
    )
    return page.screenshot()


@pytest.mark.slow
def test_a_scene_that_breaks_says_so(browser, tmp_path):
    """The tests above can fail: they see an error in the page, and so does its reader."""
    page_text = (
        scene(exoid.load_leg("cuhk"))
        .html()
        .replace('id="scene" type="text/plain">', 'id="scene" type="text/plain">AAAA', 1)
    )
    (tmp_path / "broken.html").write_text(page_text, "utf-8")
    with browser.page((tmp_path / "broken.html").as_uri()) as page:
        page.wait_for("document.querySelector('#legend summary').textContent !== ''")
        assert page.problems
        assert "cannot show" in page.evaluate("document.querySelector('#legend summary').textContent")
