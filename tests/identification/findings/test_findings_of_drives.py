"""Wrong attachment points are found in the example log, and right ones are not."""

import numpy as np
import pytest

import exoid
from exoid.actuators import LinearActuator, MomentArmTable, read_actuators
from exoid.actuators.drive_data import actuators_from_data, actuators_to_data

DATA = exoid.datasets.bleex_swing()
LEG = DATA.leg
CYLINDERS = read_actuators("bleex", LEG)
FORCES = CYLINDERS.readings(DATA.train)


def kinds(findings, kind):
    return [(f.joint, f.value) for f in findings if f.kind == kind]


@pytest.mark.parametrize(("joint", "axis"), [("left_hip", 0), ("left_knee", 2)])
def test_a_point_that_is_off_is_found_by_its_size(joint, axis) -> None:
    data = actuators_to_data(CYLINDERS)
    data[joint]["second"]["point"][axis] += 0.010
    wrong = actuators_from_data(data, LEG)
    ((found, size),) = kinds(exoid.check(LEG, FORCES, actuators=wrong), "moment-arm")
    assert found == joint
    assert 0.006 < size < 0.014
    estimate = exoid.identify(LEG, FORCES, actuators=wrong)
    assert kinds(estimate.findings, "moment-arm"), "identify finds it too"


@pytest.mark.parametrize(("joint", "point", "axis"), [("left_hip", "first", 2), ("left_knee", "second", 2)])
def test_a_mirrored_point_is_not_told_as_another_fault_alone(joint, point, axis) -> None:
    data = actuators_to_data(CYLINDERS)
    data[joint][point]["point"][axis] *= -1.0
    found = exoid.check(LEG, FORCES, actuators=actuators_from_data(data, LEG))
    assert found
    assert all("attachment points" in one.remedy for one in found if one.kind != "moment-arm")


def test_a_table_of_another_shape_is_found() -> None:
    angles = np.linspace(-0.3, 1.6, 12)
    right = CYLINDERS.drives["left_hip"].moment_arm.arm(angles)
    drives = {**CYLINDERS.drives, "left_hip": LinearActuator(MomentArmTable(angles, right))}
    assert not exoid.check(LEG, FORCES, actuators=drives)
    drives["left_hip"] = LinearActuator(MomentArmTable(angles, right * (1.0 + 0.15 * (angles - 0.6))))
    ((found, _),) = kinds(exoid.check(LEG, FORCES, actuators=drives), "moment-arm")
    assert found == "left_hip"


def test_arms_of_joints_with_torque_sensors_are_not_tested() -> None:
    data = actuators_to_data(CYLINDERS)
    data["left_hip"]["second"]["point"][0] += 0.010
    assert not exoid.check(LEG, DATA.train, actuators=actuators_from_data(data, LEG))
