"""A trial of a gait laboratory on the command line: angles, torques and ground forces in files of their own."""

import re
import shlex
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from log_writers import plate, write_columns, write_opensim
from swings import harmonics

import exoid
from exoid.leg.catalog import urdf_folder

JOINTS = ("left_hip", "left_knee", "left_ankle")
COLUMNS = ("hip_flexion_l", "knee_angle_l", "ankle_angle_l")
TRIAL = ("ik.mot", "--with", "id.sto", "--forces", "grf.mot", "--columns", "lab.toml")
POINT = (0.1, 0.05, 0.0)
"""Centre of pressure [m]."""


def coordinates(time, seed, size):
    """Positions, rates and accelerations of three coordinates, (N, 3) each."""
    rng, omega = np.random.default_rng(seed), 2.0 * np.pi * np.array([0.3, 0.5, 0.8])
    amplitude, phase = size * rng.uniform(0.3, 1.0, (3, 3)), rng.uniform(0.0, 6.3, (3, 3))
    return harmonics(time, amplitude, omega, phase)


def force_on_foot(time):
    """Force of the plate, z up [N], (N, 3)."""
    return np.column_stack([20.0 * np.sin(2.0 * time), 0.0 * time, 300.0 + 100.0 * np.cos(3.0 * time)])


def torques(time, seed=1, load=1.0):
    """Joint torques by Pinocchio: the pelvis goes forward and up and pitches, a force acts on the foot, (N, 3)."""
    model = pin.buildModelFromUrdf(str(urdf_folder() / "bleex.urdf"), pin.JointModelFreeFlyer())
    data, foot = model.createData(), model.frames[model.getFrameId("left_foot")].parentJoint
    places = [model.joints[model.getJointId(name)] for name in JOINTS]
    out = np.empty((len(time), 3))
    motion = coordinates(time, seed, 0.2), coordinates(time, seed + 1, 0.05)
    rows = zip(*motion[0], *motion[1], load * force_on_foot(time), strict=True)
    for k, (*joints, x, xd, xdd, force) in enumerate(rows):
        q, v, a = pin.neutral(model), np.zeros(model.nv), np.zeros(model.nv)
        turn, spin = pin.utils.rotate("y", x[2]), np.array([0.0, xd[2], 0.0])
        q[:7] = pin.SE3ToXYZQUAT(pin.SE3(turn, np.array([x[0], 0.0, 0.9 + x[1]])))
        v[:6] = [*(turn.T @ [xd[0], 0.0, xd[1]]), *spin]  # in the axes of the pelvis
        a[:6] = [*(turn.T @ [xdd[0], 0.0, xdd[1]] - np.cross(spin, v[:3])), 0.0, xdd[2], 0.0]
        for place, *values in zip(places, *joints, strict=True):
            q[place.idx_q], v[place.idx_v], a[place.idx_v] = values
        pin.forwardKinematics(model, data, q)
        outside = [pin.Force.Zero() for _ in range(model.njoints)]
        outside[foot] = data.oMi[foot].actInv(pin.Force(force, np.cross(POINT, force)))
        out[k] = pin.rnea(model, data, q, v, a, outside)[[place.idx_v for place in places]]
    return out


MOMENTS = tuple(f"{name}_moment" for name in COLUMNS)


def write_kinematics(path, time, seed=1):
    """Write angles and the motion of the pelvis as OpenSim's inverse kinematics does."""
    q, x, still = coordinates(time, seed, 0.2)[0], coordinates(time, seed + 1, 0.05)[0], 0.0 * time
    # OpenSim's tilt turns about z, which is -y here
    pelvis = {"pelvis_tilt": -np.rad2deg(x[:, 2]), "pelvis_list": still, "pelvis_rotation": still}
    pelvis |= {"pelvis_tx": x[:, 0], "pelvis_ty": 0.9 + x[:, 1], "pelvis_tz": still}
    angles = dict(zip(COLUMNS, np.rad2deg(q).T, strict=True))
    write_opensim(path, time, pelvis | angles, degrees=True)


def write_plate(path, time):
    """Write the force on the foot, its centre of pressure, and no free moment."""
    force = force_on_foot(time)
    write_opensim(path, time, plate(force, np.tile(POINT, (len(time), 1)), 0.0 * force))


def write_lab(path):
    """Write columns and plates of the laboratory."""
    columns = zip(JOINTS, COLUMNS, MOMENTS, strict=True)
    lines = [f'q_{joint} = "{angle}"\ntau_{joint} = "{moment}"' for joint, angle, moment in columns]
    path.write_text("\n".join(["[columns]", *lines, "[plates]", '1 = "left_foot"\n']), encoding="utf-8")


@pytest.fixture
def trial(tmp_path):
    """Write files at 100, 120 and 1000 Hz which begin at different times; the leg has no friction."""
    time, other, fast = np.arange(1200) / 100.0, 0.5 + np.arange(1300) / 120.0, np.arange(12_500) / 1000.0 - 0.2
    write_kinematics(tmp_path / "ik.mot", time)
    write_opensim(tmp_path / "id.sto", other, dict(zip(MOMENTS, torques(other).T, strict=True)))
    write_plate(tmp_path / "grf.mot", fast)
    write_lab(tmp_path / "lab.toml")
    return exoid.load_leg("bleex", side="left")


def identified(exoid_, leg):
    """Parameters of the leg that the command line finds."""
    found = exoid_("identify", "bleex", *TRIAL, "--terms", "none", "-o", "est.json", "--json").data
    assert found["inputs"][0]["name"] == "ik.mot + id.sto"
    return [found["values"][name] for name in leg.parameter_names]


def test_a_trial_in_three_files_gives_the_leg_that_moved(exoid_, trial):
    np.testing.assert_allclose(identified(exoid_, trial), trial.parameters, rtol=5e-3, atol=2e-3)
    assert max(exoid_("validate", "est.json", *TRIAL, "--json").data["nrmse"]) < 0.02


PERSON = np.array([8.0, 5.0, 0.0])
"""Amplitudes of the torques that the person exerts [N·m]."""


@pytest.mark.slow
def test_the_commands_of_the_page_lead_from_three_trials_to_what_the_person_exerts(exoid_, tmp_path):
    """12 s each of swinging, of stepping on a plate, and of being worn, with torques of the person at hip and knee."""
    page = (Path(__file__).parents[2] / "docs" / "laboratory.md").read_text(encoding="utf-8")
    commands = [shlex.split(line) for line in re.findall(r"^    exoid (.*)$", page, re.MULTILINE)]
    assert [command[0] for command in commands] == ["check", "identify", "validate", "interaction"]
    (tmp_path / "leg.urdf").write_text((urdf_folder() / "bleex.urdf").read_text(encoding="utf-8"), encoding="utf-8")
    write_lab(tmp_path / "lab.toml")
    time, fast, rng = np.arange(1200) / 100.0, np.arange(12_000) / 1000.0, np.random.default_rng(4)
    for name, seed, load in (("swing", 1, 0.0), ("step", 5, 1.0), ("walk", 7, 1.0)):
        write_kinematics(tmp_path / f"{name}_ik.mot", time, seed)
        tau = torques(time, seed, load) + 0.05 * rng.standard_normal((1200, 3))
        if name == "walk":
            tau -= PERSON * np.sin(2.0 * np.pi * 0.4 * time)[:, None]
        write_columns(tmp_path / f"{name}_machine.csv", time=time, **dict(zip(MOMENTS, tau.T, strict=True)))
        write_plate(tmp_path / f"{name}_grf.mot", fast)
    found = {command[0]: exoid_(*command, "--json").data for command in commands}
    assert max(found["validate"]["nrmse"]) < 0.05
    joints = [found["interaction"]["joints"][joint] for joint in JOINTS]
    np.testing.assert_allclose([joint["rms"] for joint in joints], PERSON / np.sqrt(2.0), rtol=0.02, atol=0.05)
    assert [joint["acts"] for joint in joints] == [True, True, False]
