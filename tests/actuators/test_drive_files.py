"""Drives as TOML files are read as written; drives that cannot be, and files that describe none, are refused."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from outcomes import refused

import exoid
from exoid.actuators import (
    Actuators,
    Attachments,
    Coupling,
    LinearActuator,
    MomentArmTable,
    Motor,
    SeriesElastic,
    read_actuators,
    write_actuators,
)
from exoid.actuators.drive_data import actuators_from_data, actuators_to_data
from exoid.errors import BadArgumentError, ExoidError, UnreadableInputError

BLEEX, CUHK = exoid.load_leg("bleex"), exoid.load_leg("cuhk")
MATRIX = ((0.05, 0.05), (0.06, -0.04))
POINTS = Attachments(("thigh", (0.05, 0.0, -0.1)), ("shank", (0.05, 0.0, -0.06)))
WRIST = Coupling(("hip", "knee"), MATRIX)
ARMS = (0.04, 0.05, 0.05, 0.04)
ONE, NOTHING = np.ones(1), np.zeros(1)
POSITIVE = st.floats(1e-6, 1e6)
SHARE = st.floats(0.01, 1.0)
MOTORS = st.builds(
    Motor,
    st.none() | POSITIVE,
    ratio=POSITIVE,
    efficiency=SHARE,
    back_efficiency=st.none() | SHARE,
    rotor_inertia=st.none() | st.floats(0.0, 1.0),
    max_current=st.none() | POSITIVE,
)
TABLES = st.lists(st.floats(0.01, 0.2), min_size=4, max_size=8).map(
    lambda arms: MomentArmTable(np.linspace(-1.0, 1.0, len(arms)), arms)
)
CYLINDERS = st.builds(LinearActuator, st.just(POINTS) | TABLES, st.none() | POSITIVE)
SPRINGS = st.builds(SeriesElastic, POSITIVE, POSITIVE)
NAMES = {*CUHK.description.child_links}


def motor(**changes):
    return lambda: Motor(**{"torque_constant": 0.1, **changes})


def points(first, second, joint="left_knee"):
    return lambda: Attachments(first, second).on(BLEEX, joint)


def on_leg(drives):
    return lambda: Actuators.of(CUHK, drives)


def currents(size):
    time = np.arange(20) / 100.0
    return exoid.Recording(time, np.zeros((20, 2)), joint_names=CUHK.joint_names, current=np.full((20, 2), size))


DRIVES = {
    "no torque per ampere": motor(torque_constant=0.0),
    "ratio zero": motor(ratio=0.0),
    "efficiency in percent": motor(efficiency=85.0),
    "unknown constant in use": lambda: Motor(None, 50.0).torque(ONE, NOTHING, NOTHING),
    "spring without stiffness": lambda: SeriesElastic(0.0),
    "one joint coupled": lambda: Coupling(("hip",), ((1.0,),)),
    "joint coupled twice": lambda: Coupling(("hip", "hip"), MATRIX),
    "singular matrix": lambda: Coupling(("hip", "knee"), ((1.0, 1.0), (1.0, 1.0))),
    "three angles": lambda: MomentArmTable((0.0, 0.1, 0.2), (1.0, 1.0, 1.0)),
    "angles twice": lambda: MomentArmTable((0.0, 0.1, 0.1, 0.3), ARMS),
    "angles in degrees": lambda: MomentArmTable((0.0, 10.0, 20.0, 30.0), ARMS),
    "arms in mm": lambda: MomentArmTable((0.0, 0.1, 0.2, 0.3), (40.0,) * 4),
    "no arm": lambda: MomentArmTable((0.0, 0.1, 0.2, 0.3), (0.0,) * 4),
    "beyond the table": lambda: MomentArmTable((0.0, 0.2, 0.4, 0.6), ARMS).arm(np.array([0.9])),
    "no such link": points(("thigh", (0.0, 0.0, -0.1)), ("tibia", (0.0, 0.0, 0.0))),
    "two joints between": points(("torso", (0.1, 0.0, 0.0)), ("shank", (0.1, 0.0, 0.0))),
    "no joint between": points(("thigh", (0.1, 0.0, 0.0)), ("thigh", (0.1, 0.0, -0.2))),
    "on the axis": points(("thigh", (0.1, 0.0, 0.0)), ("shank", (0.0, 0.0, 0.0))),
    "points that meet": points(("thigh", (0.0, 0.0, -0.33)), ("shank", (0.1, 0.0, 0.0))),
    "points in mm": points(("thigh", (50.0, 0.0, 0.0)), ("shank", (40.0, 0.0, 0.0))),
    "links alone": points("thigh", "shank"),
    "not mounted": lambda: LinearActuator(POINTS).torque(ONE, ONE, ONE),
    "arm of a number": lambda: LinearActuator(0.05),
    "no drives": on_leg({}),
    "number as drive": on_leg({"hip": 3.0}),
    "no such joint": on_leg({"ankle": Motor(0.1)}),
    "joint by two names": on_leg({"hip": Motor(0.1), "left_hip": Motor(0.1)}),
    "joint of a coupling": on_leg({"wrist": WRIST, "hip": Motor(0.1)}),
    "coupling of no joint": on_leg({"wrist": Coupling(("ankle", "knee"), MATRIX)}),
    "cylinder at another joint": on_leg({"hip": LinearActuator(POINTS)}),
    "command of one joint": lambda: on_leg({"wrist": WRIST})().command([[1.0]], [[0.0, 0.0]], [[0.0, 0.0]]),
    "command missing": lambda: on_leg({"wrist": WRIST})().command([[np.nan, 1.0]], [[0.0, 0.0]], [[0.0, 0.0]]),
}


@pytest.mark.parametrize("call", DRIVES.values(), ids=DRIVES)
def test_a_drive_that_cannot_be_is_refused(call):
    refused(BadArgumentError, call)


def test_currents_that_no_motor_has_name_the_joint():
    with pytest.raises(UnreadableInputError) as error:
        Actuators.of(CUHK, {"hip": Motor(0.1, max_current=10.0)}).torque(currents(300.0))
    assert error.value.where == "left_hip"


MOTOR = '[left_hip]\ntype = "motor"\n'
LINEAR = '[left_knee]\ntype = "linear"\n'
COUPLING = '[w]\ntype = "coupling"\n'

FILES = {
    "empty": ("", "drives.toml"),
    "no TOML": ("[left_hip", "drives.toml"),
    "no table": ("left_hip = 3", "drives.toml, [left_hip]"),
    "no type": ("[left_hip]\nratio = 3.0", "drives.toml, [left_hip]"),
    "another type": ('[left_hip]\ntype = "servo"', "drives.toml, [left_hip]"),
    "no constant": (MOTOR, "drives.toml, [left_hip]"),
    "misspelt ratio": (MOTOR + "torque_constant = 0.1\nratoi = 2.0", "drives.toml, [left_hip]"),
    "misspelt joint": ('[left_hpi]\ntype = "motor"\ntorque_constant = 0.1', "drives.toml"),
    "no points": (LINEAR, "drives.toml, [left_knee]"),
    "point without place": (LINEAR + 'first = { link = "thigh" }\nsecond = 1', "drives.toml, [left_knee]"),
    "no stiffness": ('[left_knee]\ntype = "series-elastic"', "drives.toml, [left_knee]"),
    "singular": (COUPLING + 'joints = ["hip", "knee"]\nmatrix = [[1.0, 1.0], [1.0, 1.0]]', "drives.toml, [w]"),
}


@pytest.mark.parametrize(("text", "where"), FILES.values(), ids=FILES)
def test_a_file_that_describes_no_drives_is_refused_with_file_and_table(tmp_path, monkeypatch, text, where):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "drives.toml").write_text(text, encoding="utf-8")
    with pytest.raises(ExoidError) as error:
        read_actuators("drives.toml", CUHK)
    assert error.value.where == where
    assert error.value.remedy


@pytest.mark.parametrize("content", [None, b"\xff\xfe\x00"])
def test_a_file_that_cannot_be_read_is_refused(tmp_path, content):
    if content is not None:
        (tmp_path / "drives.toml").write_bytes(content)
    with pytest.raises(UnreadableInputError):
        read_actuators(tmp_path / "drives.toml", CUHK)


@st.composite
def drives(draw):
    if draw(st.booleans()):
        size = draw(st.floats(0.01, 10.0))
        name = draw(st.text(st.characters(blacklist_categories=("Cs",)), min_size=1).filter(lambda n: n not in NAMES))
        return {name: Coupling(("hip", "knee"), ((size, size), (size, -size)))}
    return {"left_hip": draw(MOTORS | SPRINGS), "left_knee": draw(MOTORS | CYLINDERS | SPRINGS)}


@given(drives())
@settings(max_examples=60, deadline=None)
def test_what_is_written_is_read_again(tmp_path_factory, given_drives):
    actuators = Actuators.of(CUHK, given_drives)
    path = tmp_path_factory.mktemp("drives") / "drives.toml"
    write_actuators(actuators, path)
    again = read_actuators(path, CUHK)
    assert dict(again.drives) == dict(actuators.drives)
    assert dict(again.couplings) == dict(actuators.couplings)
    assert actuators_from_data(json.loads(json.dumps(actuators_to_data(actuators))), CUHK).drives == again.drives


def test_degrees_of_a_table_are_named(tmp_path):
    path = tmp_path / "drives.toml"
    path.write_text(
        '[left_knee]\ntype = "linear"\nangle_deg = [0, 30, 60, 90]\nmoment_arm = [0.04, 0.05, 0.05, 0.04]\n', "utf-8"
    )
    arm = read_actuators(path, CUHK).drives["left_knee"].moment_arm
    np.testing.assert_allclose(arm.angle, np.deg2rad([0.0, 30.0, 60.0, 90.0]))


def test_drives_of_joints_that_the_leg_does_not_move_are_left_out():
    assert set(read_actuators("bleex", BLEEX).drives) == set(BLEEX.joint_names)
    with pytest.raises(exoid.ExoidError, match="none of left_hip, left_knee"):
        Actuators.of(CUHK, {"right_hip": Motor(0.1)})
