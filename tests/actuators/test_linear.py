"""Cylinders: virtual work, Pinocchio's geometry, tables, and points that cannot be."""

import numpy as np
import pinocchio as pin
import pytest

import exoid
from exoid.actuators import Attachments, LinearActuator, MomentArmTable, read_actuators

BLEEX = exoid.load_leg("bleex")
CYLINDERS = read_actuators("bleex", BLEEX)


@pytest.mark.parametrize("joint", BLEEX.joint_names)
def test_the_length_is_the_distance_of_the_points_by_pinocchio(joint: str) -> None:
    k, model, data = BLEEX.joint_names.index(joint), BLEEX.model, BLEEX.model.createData()
    arm = CYLINDERS.drives[joint].moment_arm
    for angle in np.linspace(-1.5, 1.5, 7):
        q = np.zeros(3)
        q[k] = angle
        pin.framesForwardKinematics(model, data, q)
        ends = [
            data.oMf[model.getFrameId(end.link, pin.FrameType.BODY)].act(np.array(end.point))
            for end in (arm.first, arm.second)
        ]
        assert arm.length(np.array([angle]))[0] == pytest.approx(np.linalg.norm(ends[0] - ends[1]), rel=1e-12)


@pytest.mark.parametrize("joint", BLEEX.joint_names)
def test_virtual_work_by_finite_differences(joint: str) -> None:
    """τ q̇ = F l̇."""
    drive, h = CYLINDERS.drives[joint], 1e-6
    rng = np.random.default_rng(1)
    q, v, force = rng.uniform(-0.8, 0.8, 50), rng.normal(size=50), 1000.0 * rng.normal(size=50)
    rate = (drive.moment_arm.length(q + h * v) - drive.moment_arm.length(q - h * v)) / (2.0 * h)
    np.testing.assert_allclose(drive.torque(force, q, v) * v, force * rate, rtol=1e-7, atol=1e-6)


def test_arms_of_both_sides_are_alike_and_keep_their_sign_within_the_limits() -> None:
    right = exoid.load_leg("bleex", side="right")
    for left_joint, right_joint, low, high in zip(
        BLEEX.joint_names, right.joint_names, BLEEX.limits.lower, BLEEX.limits.upper, strict=True
    ):
        q = np.linspace(low, high, 50)
        arm = CYLINDERS.drives[left_joint].moment_arm.arm(q)
        np.testing.assert_allclose(
            read_actuators("bleex", right).drives[right_joint].moment_arm.arm(q), arm, rtol=1e-12
        )
        assert np.abs(arm).min() > 0.01
        assert (arm > 0.0).all() or (arm < 0.0).all()


def test_a_table_of_the_arm_gives_the_same_torque() -> None:
    q, force = np.linspace(-0.3, 1.2, 40), np.full(40, 700.0)
    exact = CYLINDERS.drives["left_hip"]
    angles = np.linspace(-0.4, 1.3, 15)
    table = LinearActuator(MomentArmTable(angles, exact.moment_arm.arm(angles)))
    np.testing.assert_allclose(table.torque(force, q, q), exact.torque(force, q, q), rtol=1e-4)
    change = table.moment_arm.length(q) - table.moment_arm.length(q[:1])
    np.testing.assert_allclose(change, exact.moment_arm.length(q) - exact.moment_arm.length(q[:1]), atol=1e-5)


def test_force_is_the_inverse_of_torque_and_dead_centres_are_refused() -> None:
    leg = exoid.load_leg("cuhk")
    drive = LinearActuator(Attachments(("thigh", (0.0, 0.0, 0.0)), ("shank", (0.1, 0.0, 0.0))), max_force=300.0).on(
        leg, "left_knee"
    )
    q, torque = np.array([0.3, 0.6]), np.array([4.0, -7.0])
    np.testing.assert_allclose(drive.torque(drive.command(torque, q, q), q, q), torque, rtol=1e-12)
    assert abs(drive.command(np.array([1e4]), np.array([0.5]), np.zeros(1))[0]) == 300.0
    with pytest.raises(exoid.ExoidError, match="dead centre"):
        drive.command(np.ones(1), np.array([np.pi / 2.0]), np.zeros(1))
    with pytest.raises(exoid.ExoidError, match="max_force"):
        drive.torque(np.array([3000.0]), np.zeros(1), np.zeros(1))
