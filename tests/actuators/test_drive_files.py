"""Drives as TOML files: what is written is read again, and every mistake is an error that names its place."""

import json

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
        name = draw(st.text(st.characters(blacklist_categories=("Cs",)), min_size=1).filter(lambda n: n not in NAMES))
        return {name: Coupling(("hip", "knee"), ((size, size), (size, -size)))}
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
