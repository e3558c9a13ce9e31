"""The first hour of a doctoral student: a URDF of a CAD program, a log in ms, degrees and amperes, five commands."""

import subprocess

import numpy as np
import pinocchio as pin
import pytest
from compiled import COMPILER, STRICT, needs_compiler
from swings import harmonics

import exoid

LINK = """<link name="{name}"><inertial><origin xyz="{place}"/><mass value="{mass}"/>
<inertia ixx="{inertia}" ixy="0" ixz="0" iyy="0.004" iyz="0" izz="{inertia}"/></inertial>
<visual><geometry><mesh filename="package://leg/meshes/{name}.STL"/></geometry></visual></link>"""
JOINT = """<joint name="{name}" type="revolute"><origin xyz="{place}" rpy="{turn} 0 0"/><parent link="{parent}"/>
<child link="{child}"/><axis xyz="0 0 -1"/><limit lower="0" upper="0" effort="0" velocity="0"/></joint>"""
DRIVES = '[{}]\ntype = "motor"\ntorque_constant = 0.1\nratio = 50.0\nrotor_inertia = 2e-5\n'
LAB = """
[columns]
time = "t:ms"
q_Hip = "hip_deg:deg"
q_Knee = "knee_deg:deg"
i_Hip = "hip_A"
i_Knee = "knee_A"
"""
FRICTION, DAMPING, PER_AMPERE = np.array([2.0, 1.0]), np.array([0.5, 0.3]), 5.0


def urdf(thigh, shank):
    """As the exporter of SolidWorks writes it: five digits, limits of zero, meshes of a package that is not there."""
    links = [
        LINK.format(name="base_link", place="0 0.03 0", mass=2.0, inertia=0.005),
        LINK.format(name="thigh", place="0.0104 -0.2012 0.0021", mass=thigh, inertia=0.0133 * thigh),
        LINK.format(name="shank", place="-0.0021 -0.15 0.001", mass=shank, inertia=0.0105 * shank),
    ]
    joints = [
        JOINT.format(name="Hip", place="0 0.05 0", turn=1.5708, parent="base_link", child="thigh"),
        JOINT.format(name="Knee", place="0 -0.43 0", turn=0, parent="thigh", child="shank"),
    ]
    return f'<robot name="leg">{"".join(links + joints)}</robot>'


def write_log(path, model, seed):
    """Write a log of 40 s, torques by Pinocchio."""
    rng, time = np.random.default_rng(seed), np.arange(4000) / 100.0
    omega = 2.0 * np.pi * 0.1 * np.arange(1, 6)
    amplitude, phase = rng.uniform(0.05, 0.2, (2, 5)), rng.uniform(0.0, 6.3, (2, 5))
    q, v, a = harmonics(time, amplitude, omega, phase)
    q[:, 1] += 0.8
    data, rotors = model.createData(), 2e-5 * 50.0**2
    tau = np.array([pin.rnea(model, data, *row) for row in zip(q, v, a, strict=True)])
    tau += rotors * a + FRICTION * np.tanh(v / 0.015) + DAMPING * v + 0.1 * rng.standard_normal(q.shape)
    q += 5e-5 * rng.standard_normal(q.shape)
    table = np.column_stack([1e3 * time, np.rad2deg(q), tau / PER_AMPERE])
    np.savetxt(path, table, delimiter=",", header="t,hip_deg,knee_deg,hip_A,knee_A", comments="", fmt="%.6f")


@pytest.fixture
def folder(tmp_path):
    """Files of the student; the CAD is 30 % too light."""
    (tmp_path / "leg.urdf").write_text(urdf(2.2, 1.3), encoding="utf-8")
    (tmp_path / "true.urdf").write_text(urdf(3.1, 1.9), encoding="utf-8")
    (tmp_path / "lab.toml").write_text(LAB, encoding="utf-8")
    (tmp_path / "drives.toml").write_text(DRIVES.format("Hip") + DRIVES.format("Knee"), encoding="utf-8")
    model = pin.buildModelFromUrdf(str(tmp_path / "true.urdf"))
    for name, seed in (("train.csv", 1), ("test.csv", 2)):
        write_log(tmp_path / name, model, seed)
    return tmp_path


@pytest.mark.slow
@needs_compiler
def test_five_commands_lead_from_a_log_to_a_urdf_and_to_c_in_amperes(exoid_, folder):
    reading = ("--columns", "lab.toml", "--actuators", "drives.toml")
    commands = (
        ("check", "leg.urdf", "train.csv", *reading),
        ("identify", "leg.urdf", "train.csv", *reading, "-o", "est.json", "--report", "report.html"),
        ("validate", "est.json", "test.csv", "--columns", "lab.toml"),
        ("export", "est.json", "-o", "identified.urdf"),
        ("export", "est.json", "--law", "gravity_friction_pd", "--c", "law.c", "--limit", "40,30"),
    )
    for command in commands:
        run = exoid_(*command)
        assert run.code == 0, f"{command}: {run.err}"
        assert "verdict: predicts\n" in run.out or command[0] != "validate", run.out
    true, found = exoid.Leg.from_urdf(folder / "true.urdf"), exoid.Leg.from_urdf(folder / "identified.urdf")
    names = [name for name in true.parameter_names if name[0] in "XJ"]
    for leg in (exoid.Estimate.load(folder / "est.json").leg, found):
        values, expected = (dict(zip(each.parameter_names, each.parameters, strict=True)) for each in (leg, true))
        np.testing.assert_allclose([values[k] for k in names], [expected[k] for k in names], rtol=0.06, atol=0.01)
    assert "law_command" in (folder / "law.h").read_text(encoding="utf-8")
    subprocess.run([COMPILER, *STRICT, "-c", folder / "law.c", "-o", folder / "law.o"], check=True)
