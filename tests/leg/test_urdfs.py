"""The URDFs in urdf/: their numbers, their geometry, and three libraries that must read them alike."""

import math
import xml.etree.ElementTree as ET
from pathlib import Path

import make_urdfs
import numpy as np
import pinocchio as pin
import pytest

ROOT = Path(__file__).resolve().parents[2]
URDFS = ("bleex.urdf", "bleex_identified.urdf", "cuhk.urdf", "dfki_double_pendulum.urdf")


def model_of(name: str, *, floating: bool = False) -> pin.Model:
    """Pinocchio's model; floating keeps the root link as a body."""
    path = str(ROOT / "urdf" / name)
    return pin.buildModelFromUrdf(path, pin.JointModelFreeFlyer()) if floating else pin.buildModelFromUrdf(path)


def test_the_double_pendulum_has_the_published_model():
    model = model_of("dfki_double_pendulum.urdf")
    published_model = {"shoulder": (0.608, 0.275, 0.05472), "elbow": (0.630, 0.166, 0.02522)}
    for joint, (m, r, about_joint) in published_model.items():
        inertia = model.inertias[model.getJointId(joint)]
        assert (inertia.mass, tuple(inertia.lever)) == (m, (0.0, 0.0, -r))
        assert inertia.inertia[1, 1] + m * r**2 == pytest.approx(about_joint, abs=1e-15)
    elbow = model.jointPlacements[model.getJointId("elbow")].translation
    assert tuple(elbow) == (0.0, 0.0, -0.3)


DEG = math.pi / 180
BLEEX_JOINTS = {  # axis, limits [deg], effort, velocity
    "hip": ((0, -1, 0), (-10, 121), 150, 6),
    "knee": ((0, -1, 0), (-121, 0), 125, 8),
    "ankle": ((0, -1, 0), (-45, 45), 150, 8),
}
CUHK_JOINTS = {"hip": ((0, -1, 0), (-30, 110), 80, 6.5), "knee": ((0, 1, 0), (-15, 120), 60, 6.5)}


def expected_joints(name: str) -> dict[str, tuple]:
    if name.startswith("dfki"):
        turn = ((0, -1, 0), (-360, 360), 10, 20)
        return {"shoulder": turn, "elbow": turn}
    joints = CUHK_JOINTS if name == "cuhk.urdf" else BLEEX_JOINTS
    return {f"{side}_{joint}": facts for side in ("left", "right") for joint, facts in joints.items()}


@pytest.mark.parametrize("name", URDFS)
def test_joints_have_their_names_axes_and_limits(name):
    joints = {joint.get("name"): joint for joint in ET.parse(ROOT / "urdf" / name).iterfind("joint")}
    assert set(joints) == set(expected_joints(name))
    for joint_name, (axis, degrees, effort, velocity) in expected_joints(name).items():
        joint = joints[joint_name]
        assert joint.get("type") == "revolute"
        assert tuple(float(a) for a in joint.find("axis").get("xyz").split()) == axis
        limit = {key: float(value) for key, value in joint.find("limit").attrib.items()}
        expected = {"lower": degrees[0] * DEG, "upper": degrees[1] * DEG, "effort": effort, "velocity": velocity}
        assert limit == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize(
    ("name", "joints", "height"),
    [("bleex.urdf", ("hip", "knee", "ankle"), 0.43), ("cuhk.urdf", ("hip", "knee"), 0.4165)],
)
@pytest.mark.parametrize(("side", "sign"), [("left", 1), ("right", -1)])
def test_the_leg_hangs_straight_down_at_the_zero_pose(name, joints, height, side, sign):
    model = model_of(name)
    data = model.createData()
    pin.forwardKinematics(model, data, pin.neutral(model))
    for k, joint in enumerate(joints):
        placement = data.oMi[model.getJointId(f"{side}_{joint}")]
        np.testing.assert_allclose(placement.translation, [0.0, sign * 0.20, -k * height], atol=1e-15)
        np.testing.assert_array_equal(placement.rotation, np.eye(3))


@pytest.mark.parametrize(
    ("name", "flexed"), [("bleex.urdf", {"hip": 0.5, "knee": -1.0}), ("cuhk.urdf", {"hip": 0.5, "knee": 1.0})]
)
@pytest.mark.parametrize("side", ["left", "right"])
def test_flexion_brings_the_knee_forward_and_the_shank_back(name, flexed, side):
    model = model_of(name)
    data, q = model.createData(), pin.neutral(model)
    for joint, angle in flexed.items():
        q[model.joints[model.getJointId(f"{side}_{joint}")].idx_q] = angle
    pin.forwardKinematics(model, data, q)
    knee = data.oMi[model.getJointId(f"{side}_knee")]
    assert knee.translation[0] > 0.1
    assert (knee.rotation @ [0.0, 0.0, -1.0])[0] == pytest.approx(-math.sin(0.5))


@pytest.mark.parametrize("name", URDFS)
def test_the_file_is_what_the_script_writes(name):
    assert set(make_urdfs.robots()) == set(URDFS)
    assert make_urdfs.urdf(make_urdfs.robots()[name]).encode() == (ROOT / "urdf" / name).read_bytes()
