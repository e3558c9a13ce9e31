"""Drives as TOML files: what is written is read again, and every mistake is an error that names its place."""

from __future__ import annotations

import contextlib
import json
import string

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

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
from exoid.actuators.transmission import read_transmissions

BLEEX, CUHK = exoid.load_leg("bleex"), exoid.load_leg("cuhk")
POINTS = Attachments(("thigh", (0.05, 0.0, -0.10)), ("shank", (0.05, 0.0, -0.06)))
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
LINEAR = st.builds(LinearActuator, st.just(POINTS) | TABLES, st.none() | POSITIVE)
SPRINGS = st.builds(SeriesElastic, POSITIVE, POSITIVE)


@st.composite
def drives(draw):
    if draw(st.booleans()):
        size = draw(st.floats(0.01, 10.0))
        motors = draw(st.just(()) | st.tuples(MOTORS, MOTORS))
        name = draw(st.text(st.characters(blacklist_categories=("Cs",)), min_size=1).filter(lambda n: n not in NAMES))
        return {name: Coupling(("hip", "knee"), ((size, size), (size, -size)), motors)}
    return {"left_hip": draw(MOTORS | SPRINGS), "left_knee": draw(MOTORS | LINEAR | SPRINGS)}


NAMES = {*CUHK.description.child_links}


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


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(string.printable, max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(["link", "point", "x"]), inner),
    max_leaves=6,
)
KEYS = [
    "type",
    "torque_constant",
    "ratio",
    "efficiency",
    "rotor_inertia",
    "max_current",
    "first",
    "second",
    "angle",
    "angle_deg",
    "moment_arm",
    "max_force",
    "stiffness",
    "joints",
    "matrix",
    "motors",
]
TYPES = st.sampled_from(["motor", "linear", "series-elastic", "coupling"])


@pytest.mark.slow
@given(
    st.dictionaries(
        st.sampled_from(["hip", "left_knee", "wrist"]),
        st.dictionaries(st.sampled_from(KEYS), VALUES | TYPES).flatmap(
            lambda table: st.just(table) | TYPES.map(lambda kind: {**table, "type": kind})
        )
        | VALUES,
    )
)
@settings(max_examples=150, deadline=None)
def test_any_table_is_read_or_refused(data):
    with contextlib.suppress(exoid.ExoidError):
        assert isinstance(actuators_from_data(data, CUHK), Actuators)


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


URDF = """<robot name="one"><link name="base"/><link name="thigh"><inertial><mass value="2"/>
<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
<joint name="hip" type="revolute"><parent link="base"/><child link="thigh"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="9" velocity="1"/></joint>
<transmission name="gear"><type>transmission_interface/SimpleTransmission</type>{joint}
<actuator name="m"><mechanicalReduction>{ratio}</mechanicalReduction></actuator>{more}</transmission></robot>"""


def one_joint(ratio="100", joint='<joint name="hip"/>', more=""):
    text = URDF.format(ratio=ratio, joint=joint, more=more)
    return exoid.Leg.from_description(exoid.leg.description.describe(text, "one.urdf"))


def test_transmissions_give_ratio_and_efficiency():
    leg = one_joint(more="<efficiency>0.8</efficiency>")
    assert read_transmissions(leg.description)["hip"].motor(0.05) == Motor(0.05, ratio=100.0, efficiency=0.8)
    motors = actuators_from_data({"hip": {"type": "motor", "torque_constant": 0.05}}, leg)
    assert motors.drives["hip"] == Motor(0.05, ratio=100.0, efficiency=0.8)
    with pytest.raises(exoid.ExoidError, match=r"ratio is 50\.0, and <transmission> of the URDF says 100"):
        actuators_from_data({"hip": {"type": "motor", "torque_constant": 0.05, "ratio": 50.0}}, leg)


def test_an_estimate_keeps_a_ratio_that_differs_from_that_of_the_urdf(tmp_path):
    leg = one_joint()
    time = np.arange(2000) / 100.0
    q = (0.5 * np.sin(1.7 * time) + 0.3 * np.sin(4.1 * time + 1.0))[:, None]
    log = exoid.Recording(time=time, q=q, current=np.cos(q) + 0.1 * q, joint_names=("hip",))
    estimate = exoid.identify(leg, log, actuators={"hip": Motor(0.1, ratio=50.0)}, check=False)
    estimate.save(tmp_path / "est.json")
    assert exoid.Estimate.load(tmp_path / "est.json").actuators.drives["hip"].ratio == 50.0


@pytest.mark.parametrize(
    ("given", "what"),
    [
        ({"ratio": "many"}, "mechanicalReduction is many"),
        ({"joint": '<joint name="knee"/>'}, "no joint 'knee'"),
        ({"more": '</transmission><transmission name="b"><joint name="hip"/>'}, "two transmissions of joint 'hip'"),
    ],
)
def test_mistakes_in_transmissions_are_errors(given, what):
    with pytest.raises(exoid.ExoidError, match=what):
        read_transmissions(one_joint(**given).description)


def test_transmissions_of_several_joints_are_left_out():
    assert read_transmissions(one_joint(joint='<joint name="hip"/><joint name="knee"/>').description) == {}
