"""The torque of the wearer in figures, in the report and in the scene."""

import dataclasses
import re

import numpy as np
import pytest
from matplotlib.figure import Figure
from worn import log, push, swing, unworn_estimate

import exoid
from exoid import ExoidError
from exoid.control.wearer.gait import profile
from exoid.view import plot_interaction, scene
from exoid.view.forces import draw_gait_profile
from exoid.view.report import interaction_report


@pytest.fixture(scope="module")
def estimate(leg):
    return unworn_estimate(leg)


@pytest.fixture(scope="module")
def recording(leg):
    motion = swing(leg, 7, seconds=12.0)
    return log(motion, push(motion))


@pytest.fixture(scope="module")
def found(estimate, recording):
    return exoid.interaction(estimate, recording)


@pytest.fixture(scope="module")
def drawn(estimate, recording, found):
    return scene(estimate, recording=recording, interaction=found)


def arrows(drawn, name="torque of the wearer"):
    return [path for layer in drawn.layers if layer.label == name for path in layer.paths]


def test_the_scene_has_an_arrow_for_each_joint_that_follows_the_torque(drawn, recording, found):
    paths = arrows(drawn)
    assert len(paths) == len(found.joint_names)
    (animation,) = [command for command in drawn.commands if command["type"] == "set_animation"]
    tracks = {each["path"]: each["clip"]["tracks"] for each in animation["animations"]}
    for path, torque in zip(paths, found.torque.T, strict=True):
        (track,) = tracks[f"{path}/arrow"]
        scales = np.array([key["value"] for key in track["keys"]])
        times = recording.time[0] + np.array([key["time"] for key in track["keys"]]) / 30.0
        known = (times > found.time[0]) & (times < found.time[-1])
        size = np.interp(times, found.time, torque)[known]
        area = scales[known, 0] ** 2
        assert np.corrcoef(area, np.abs(size))[0, 1] > 0.99
        big = np.abs(size) > 0.1
        assert (np.sign(scales[known, 1])[big] == np.sign(size)[big]).all()


def test_arrows_of_the_wearer_have_their_own_scale(drawn, found):
    scales = {layer.label: layer.scale for layer in drawn.layers}
    length, torque = re.fullmatch(r"radius of ([0-9.]+) m = ([0-9.]+) N·m", scales["torque of the wearer"]).groups()
    assert length == scales["measured torque"].split()[2]
    assert float(torque) == pytest.approx(np.abs(found.torque).max(), rel=0.01)
    assert scales["measured torque"] != scales["torque of the wearer"]


def test_the_prediction_beside_a_wearer_is_that_without_one(drawn, estimate, recording):
    assert drawn.to_json()["predicted"] == "predicted without wearer"
    assert scene(estimate, recording=recording).to_json()["predicted"] == "predicted"


def test_no_arrow_where_nothing_was_evaluated(estimate, recording, found):
    later = dataclasses.replace(found, time=found.time + 100.0)
    assert len(arrows(scene(estimate, recording=recording, interaction=later))) == len(found.joint_names)


def test_an_interaction_needs_its_recording(estimate, recording, found):
    with pytest.raises(ExoidError, match="without a recording"):
        scene(estimate, interaction=found)


def test_a_leg_without_the_joints_has_no_arrow(recording, found, estimate):
    other = exoid.load_leg("bleex", "right")
    drawn = scene(estimate, other, recording=recording, interaction=found)
    assert len(arrows(drawn)) == len(found.joint_names)


def test_the_report_shows_every_joint_and_the_findings(estimate, recording, found):
    page = interaction_report(estimate, found, recording)
    titles = [section.title for section in page.sections]
    assert titles[0] == "Torque of the wearer"
    assert "Replay" in titles
    over_time = next(section for section in page.sections if section.title == "Over time")
    assert len(over_time.blocks) == len(found.joint_names)
    short = exoid.interaction(estimate, recording.between(recording.time[0], recording.time[0] + 1.0))
    assert "Findings" in [section.title for section in interaction_report(estimate, short, recording).sections]


def test_the_figures_draw_what_they_are_given(found):
    ax = Figure().add_subplot()
    plot_interaction(ax, found.time, found.torque[:, 0], found.band[:, 0], "hip")
    assert "torque of the wearer" in {line.get_label() for line in ax.lines}
    phase, figure = (found.time % 2.0) / 2.0, Figure()
    draw_gait_profile(figure, profile(found.torque, found.velocity, phase), found.joint_names)
    above, below = figure.axes
    curves = [line for line in above.lines if len(line.get_xdata()) == 20]
    assert len(curves) == len({line.get_linestyle() for line in curves}) == len(found.joint_names)
    assert below.get_ylabel() == "power on\nthe leg [W]"
