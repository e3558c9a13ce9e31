"""A machine with a slide and a hinge: tables, JSON and figures have N and mm for the one, N·m and ° for the other."""

import numpy as np
import pytest
from matplotlib.figure import Figure
from small_urdfs import BODY
from swings import harmonics, log_of

import exoid
from exoid.view.report.fit import friction_blocks, predict_recording, torque_blocks
from exoid.view.report.page import Picture

URDF = (
    f'<robot name="lift"><link name="torso"/><link name="carriage">{BODY}</link><link name="arm">{BODY}</link>'
    '<joint name="lift" type="prismatic"><parent link="torso"/><child link="carriage"/><axis xyz="0 0 1"/>'
    '<limit lower="-0.2" upper="0.3" effort="400" velocity="1"/></joint>'
    '<joint name="swing" type="revolute"><origin xyz="0 0 -0.1"/><parent link="carriage"/><child link="arm"/>'
    '<axis xyz="0 -1 0"/><limit lower="-1.5" upper="1.5" effort="40" velocity="8"/></joint></robot>'
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The URDF, a log of 8 s, and what is identified from it."""
    folder = tmp_path_factory.mktemp("lift")
    (folder / "lift.urdf").write_text(URDF, encoding="utf-8")
    leg, time = exoid.Leg.from_urdf(folder / "lift.urdf"), np.arange(1600) / 200.0
    w, size = 2.0 * np.pi * np.array([[0.3, 0.7, 1.1]]), np.array([[0.05, 0.03, 0.015], [0.5, 0.3, 0.15]])
    q, v, a = harmonics(time, size, w, np.array([0.0, 1.0, 2.0]))
    friction = np.array([14.0, 1.0]) * np.tanh(v / [1e-3, 0.01]) + np.array([20.0, 0.5]) * v
    log = log_of(leg, time, (q, v, a), friction, np.array([0.5, 0.05]))
    log.to_csv(folder / "log.csv")
    exoid.identify(leg, log).save(folder / "est.json")
    return folder


MIXED = {
    ("validate", "est.json", "log.csv"): ["RMSE [N or N·m]"],
    ("interaction", "est.json", "log.csv"): ["RMS [N or N·m]"],
    ("track", "est.json", "--dry-run", "log.csv"): ["rms [N or", "[N/s or"],
    ("identify", "lift.urdf", "log.csv"): ["residual RMS [N or N·m]"],
    ("plan", "lift.urdf", "--assess", "log.csv"): ["N or N·m (white, assumed)"],
}


@pytest.mark.parametrize("verb", MIXED, ids=lambda verb: verb[0])
def test_tables_name_both_units(exoid_, folder, verb):
    printed = exoid_(verb[0], *(folder / word if "." in word else word for word in verb[1:])).printed
    assert all(heading in printed for heading in MIXED[verb])
    assert "[N·m]" not in printed


def test_json_has_the_units_of_its_numbers(exoid_, folder):
    """The numbers are N of the slide and N·m of the hinge, of which the noise is known."""
    files = folder / "est.json", folder / "log.csv"
    validated = exoid_("validate", *files, "--json").data
    assert validated["torque_units"] == ["N", "N·m"]
    felt = exoid_("interaction", *files, "--json").data["joints"]
    assert [felt[name]["torque_unit"] for name in ("lift", "swing")] == ["N", "N·m"]
    replayed = exoid_("track", files[0], "--dry-run", files[1], "--json").data
    assert (replayed["joint_names"], replayed["torque_units"]) == (["lift", "swing"], ["N", "N·m"])
    assert replayed["rms_torque"][0] == pytest.approx(4.0 * 9.81, rel=0.02)  # weight of two bodies of 2 kg
    assert 0.1 < validated["rmse"][0] < 0.5  # noise of 0.5 N, low-passed
    assert 0.01 < validated["rmse"][1] < 0.05


def test_pictures_of_an_estimate_have_the_unit_of_each_joint(folder):
    """Friction and prediction, as the report draws them; the lines are those of the log."""
    estimate = exoid.Estimate.load(folder / "est.json")
    log = exoid.Recording.from_csv(folder / "log.csv", estimate.joint_names)
    predictions = [predict_recording(estimate, log, None)]
    labels = {}
    for block in (*torque_blocks(estimate, predictions, held_out=True), *friction_blocks(estimate, predictions)):
        if isinstance(block, Picture):
            figure = Figure()
            block.draw(figure)
            labels |= {ax.get_ylabel(): ax for ax in figure.axes}
    assert {"lift force [N]", "swing torque [N·m]", "lift friction [N]", "swing friction [N·m]"} <= set(labels)
    assert {"residual [N]", "residual [N·m]"} <= set(labels)
    assert labels["lift friction [N]"].get_xlabel() == "lift velocity [m/s]"
    measured = labels["lift force [N]"].lines
    assert any(np.median(line.get_ydata()) == pytest.approx(4.0 * 9.81, abs=8.0) for line in measured)
