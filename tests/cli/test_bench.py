"""A leg on a bench, by the command line: one column of a load cell, and a joint that turns round and round."""

import csv
import json

import numpy as np
import pytest

import exoid

LEG = exoid.load_leg("cuhk")
PLACE = (0.0, 0.0, -0.3)
DRIVES = "".join(
    f'[{joint}]\ntype = "motor"\ntorque_constant = "unknown"\nratio = 50.0\n\n' for joint in ("left_hip", "left_knee")
)
FLYWHEEL = """<robot name="flywheel"><link name="frame"/>
<joint name="hub" type="continuous"><parent link="frame"/><child link="wheel"/><axis xyz="0 1 0"/></joint>
<link name="wheel"><inertial><origin xyz="0 0 -0.2"/><mass value="2"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""


def write(path, columns):
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(np.column_stack(list(columns.values())).tolist())


def sines(seed, joints, seconds=20.0):
    rng, t = np.random.default_rng(seed), np.arange(0.0, seconds, 0.01)
    w, phase = 2.0 * np.pi * rng.uniform(0.2, 1.2, (4, joints)), rng.uniform(0.0, 6.3, (4, joints))
    angle = w * t[:, None, None] + phase
    return (t, *(0.2 * x.sum(axis=1) for x in (np.sin(angle), w * np.cos(angle), -(w**2) * np.sin(angle))))


@pytest.fixture
def columns(tmp_path, monkeypatch):
    """Currents of a leg, and the force that a load cell measures along one axis."""
    monkeypatch.chdir(tmp_path)
    t, q, v, a = sines(1, 2)
    force = 30.0 * np.sin(4.4 * t) + 20.0 * np.sin(9.0 * t)
    jacobian = LEG.frame_jacobian(q, "left_shank", PLACE)[:, 0]  # along x, (N, n)
    tau = LEG.inverse_dynamics(q, v, a) - jacobian * force[:, None] + 0.8 * np.tanh(v / 0.01)
    current = tau / (50.0 * np.array([0.07, 0.05])) + 0.02 * np.random.default_rng(2).standard_normal(q.shape)
    (tmp_path / "drives.toml").write_text(DRIVES)
    named = zip(LEG.joint_names, q.T, current.T, strict=True)
    found = {"time": t} | {
        name: values for joint, *two in named for name, values in zip((f"q_{joint}", f"i_{joint}"), two, strict=True)
    }
    return found | {"wrench_left_shank_fx": force}


def test_one_column_of_a_load_cell_gives_torque_constants(exoid_, tmp_path, columns):
    write(tmp_path / "log.csv", columns)
    found = exoid_(
        "identify", "cuhk", "log.csv", "--actuators", "drives.toml", "--wrench", "left_shank:link@0,0,-0.3", "--json"
    )
    assert found.code == 0, found.err
    data = json.loads(found.out)
    assert data["shapes"]["values"]["kt_hip"] == pytest.approx(0.07, rel=0.01)
    assert data["shapes"]["values"]["kt_knee"] == pytest.approx(0.05, rel=0.01)
    assert data["values"]["X2"] == pytest.approx(LEG.parameters[3], rel=0.02)


def test_a_joint_may_turn_round_and_round_if_one_says_so(exoid_, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "wheel.urdf").write_text(FLYWHEEL)
    leg = exoid.Leg.from_urdf("wheel.urdf")
    t, q, v, a = sines(3, 1)
    q, v = q + 2.0 * t[:, None], v + 2.0
    tau = leg.inverse_dynamics(q, v, a) + 0.01 * np.random.default_rng(4).standard_normal(q.shape)
    write(tmp_path / "log.csv", {"time": t, "q_hub": q[:, 0], "tau_hub": tau[:, 0]})
    refused = exoid_("identify", "wheel.urdf", "log.csv")
    assert refused.code == 2
    assert "--radians if the joint really turns that far" in refused.err
    found = exoid_("identify", "wheel.urdf", "log.csv", "--radians", "--terms", "none", "--json")
    assert found.code == 0, found.err
    np.testing.assert_allclose(list(json.loads(found.out)["values"].values()), leg.parameters, atol=0.01)
