"""``exoid view`` shows what its words say, or ends in one line."""

import json
import re
from functools import partial
from pathlib import Path

import pytest
from drawings import scene_of

from exoid.view.scenes.server import SceneServer


@pytest.fixture
def view(exoid_, saved):
    """Run ``exoid view ARGUMENTS`` in a folder with an estimate and a URDF."""
    Path("leg.urdf").write_text(saved.model.leg.description.text, encoding="utf-8")
    return partial(exoid_, "view")


def page():
    return scene_of(Path("leg.html").read_text(encoding="utf-8"))


def labels():
    return [layer["label"] for layer in page()["layers"]]


def test_a_built_in_leg_becomes_a_page(view):
    code, out, err = view("bleex", "--html", "leg.html")
    assert (code, err) == (0, "")
    assert re.fullmatch(r"wrote leg\.html \(0\.\d\d MB\)\n", out)
    assert page()["title"] == "bleex, left leg"
    assert labels() == ["leg", "joint axes", "centres of mass", "CAD inertia", "weights", "torque against gravity"]


def test_an_estimate_replays_a_log(view):
    code, _, err = view("est.json", "--log", "bleex_swing:test", "--stop", "4", "--html", "leg.html")
    assert (code, err) == (0, "")
    assert page()["duration"] == pytest.approx(4.0, abs=0.05)
    assert {"identified inertia", "measured torque"} <= set(labels())


def test_a_slide_is_posed_in_mm(view):
    urdf = Path("leg.urdf").read_text(encoding="utf-8").replace("revolute", "prismatic")
    Path("slide.urdf").write_text(urdf, encoding="utf-8")
    assert view("slide.urdf", "--joints", "left_knee", "--pose", "left_knee=100", "--html", "leg.html").code == 0
    (moved,) = [each["matrix"] for each in page()["commands"] if each["path"].endswith("left_knee/body")]
    assert sum(x * x for x in moved[12:15]) == pytest.approx(0.1**2)


@pytest.mark.parametrize("as_json", [False, True])
def test_the_address_is_printed_and_a_browser_opened(view, monkeypatch, as_json):
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    monkeypatch.setattr(SceneServer, "wait", lambda self: None)
    code, out, err = view("cuhk", "--port", "0", *(["--json"] if as_json else []))
    assert (code, err) == (0, "ended\n")
    (url,) = opened
    if as_json:
        assert json.loads(out) == {"url": url, "port": int(url.rsplit(":")[-1].strip("/"))}
    else:
        assert url in out
        assert "this machine only" in out
    view("cuhk", "--port", "0", "--no-browser")
    assert opened == [url]
