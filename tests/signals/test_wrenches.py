"""Wrenches and contacts of a recording: mechanics of a wrench, what is carried along, and what is refused."""

import copy
import dataclasses
import pickle

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from walking import IMU, Walk

import exoid
from exoid import BaseMotion, BasePose, ExoidError, Recording, Wrench
from exoid.identification.findings.sample import averaged
from exoid.signals import ZeroPhase, turn_upright

N = 400
TIME = np.arange(N) / 100.0


def standing(axes="link", moving=False, seed=0):
    """A ground force of about 400 N under a foot."""
    rng = np.random.default_rng(seed)
    force = rng.normal(size=(N, 3)) * 20.0 + (0.0, 0.0, 400.0)
    point = rng.normal(size=(N, 3)) * 0.05 if moving else (0.05, 0.0, -0.08)
    return Wrench(force, np.cross(rng.normal(size=(N, 3)) * 0.1, force), point, axes)


def recording(**changes):
    stance = np.sin(2.0 * TIME) > 0.0
    return Recording(
        TIME,
        0.3 * np.sin(TIME)[:, None],
        joint_names=("knee",),
        **{"wrenches": {"left_foot": standing()}, "contacts": {"left_foot": stance, "right_foot": ~stance}, **changes},
    )


# --- A wrench -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("moving", [False, True])
def test_a_wrench_about_another_point_has_the_same_power_for_every_twist(moving):
    """P = f · v(p) + m · ω does not depend on the point, with v(p) = v + ω × p."""
    wrench = standing("world", moving)
    velocity, omega = np.random.default_rng(3).normal(size=(2, N, 3))

    def power(one):
        at_point = velocity + np.cross(omega, one.point)
        return np.sum(one.force * at_point + one.moment * omega, axis=1)

    for point in ((0.3, -0.2, 1.0), np.random.default_rng(4).normal(size=(N, 3))):
        assert np.allclose(power(wrench.about(point)), power(wrench), rtol=0, atol=1e-9)


def test_a_wrench_is_averaged_and_interpolated_about_one_point():
    """A centre of pressure that jumps where the foot lifts must not become a moment."""
    loaded = TIME < 2.0
    centre = np.where(loaded[:, None], (0.1, 0.0, 0.0), (0.0, 0.0, 0.0))
    wrench = Wrench(np.where(loaded, 500.0, 0.0)[:, None] * (0.0, 0.0, 1.0), np.zeros((N, 3)), centre, "world")
    for one in (wrench.averaged(7), wrench.interpolated(TIME, np.arange(0.0, 3.9, 0.003))):
        assert np.allclose(one.point, (0.1, 0.0, 0.0))
        assert np.allclose(one.moment, 0.0, atol=1e-12)
        assert one.force[:, 2].max() <= 500.0 + 1e-9
    averaged = standing().averaged(4)
    assert np.allclose(averaged.force[1], standing().force[4:8].mean(axis=0))
    assert len(averaged) == N // 4


@pytest.mark.parametrize(("of_force", "of_moment"), [(1e-3, 1.0), (1.0, 1e3), (0.1, 100.0)])
def test_force_plates_in_kilonewtons_or_newton_millimetres_are_refused(of_force, of_moment):
    wrench = standing()
    with pytest.raises(ExoidError, match="moments look like N·mm, or forces like kN"):
        Wrench(of_force * wrench.force, of_moment * wrench.moment)


# --- A recording with wrenches and contacts ---------------------------------------------------------------------------


def equal(one, other):
    assert np.array_equal(one.columns, other.columns)
    assert np.array_equal(one.point, other.point)
    assert one.axes == other.axes


def test_resampling_interpolates_wrenches_and_shortens_contacts():
    whole = recording()
    kept = np.arange(len(whole)) % 9 != 7  # samples that were lost
    lossy = dataclasses.replace(
        whole,
        **{name: getattr(whole, name)[kept] for name in ("time", "q", "tau") if getattr(whole, name) is not None},
        wrenches={link: wrench.rows(kept) for link, wrench in whole.wrenches.items()},
        contacts={link: contact[kept] for link, contact in whole.contacts.items()},
    )
    found = lossy.resampled()
    rows = kept[: len(found)]
    assert np.allclose(
        found.wrenches["left_foot"].columns[rows], lossy.wrenches["left_foot"].columns[: rows.sum()], atol=1e-6
    )
    before, after = np.roll(whole.contacts["left_foot"], 1), np.roll(whole.contacts["left_foot"], -1)
    assert np.array_equal(
        found.contacts["left_foot"], np.where(kept, whole.contacts["left_foot"], before & after)[: len(found)]
    )


def test_mappings_cannot_be_changed_and_can_be_sent_to_other_processes():
    whole = recording()
    with pytest.raises(TypeError):
        whole.wrenches["right_foot"] = standing()
    with pytest.raises(ValueError, match="read-only"):
        whole.contacts["left_foot"][0] = True
    for twin in (pickle.loads(pickle.dumps(whole)), copy.deepcopy(whole)):
        equal(twin.wrenches["left_foot"], whole.wrenches["left_foot"])
        assert np.array_equal(twin.contacts["left_foot"], whole.contacts["left_foot"])


# --- The pose of the base ---------------------------------------------------------------------------------------------


def walk():
    return Walk(exoid.load_leg("cuhk"), seconds=12.0, sideways=0.1)


def test_a_pose_is_that_of_the_root_link_whatever_was_tracked():
    walked = walk()
    position, turn = walked.pose
    base = BaseMotion.from_pose(position + turn.apply(IMU), turn.as_quat(), walked.time, at=IMU)
    inner = slice(50, -50)
    assert np.abs(base.pose.position - position)[inner].max() < 1e-4
    assert np.abs(base.pose.rotation - turn.as_matrix())[inner].max() < 1e-4
    assert np.array_equal(base.rows(slice(3, 20)).pose.position, base.pose.position[3:20])
    assert np.allclose(base.averaged(5).pose.position[2], base.pose.position[10:15].mean(axis=0))
    grid = np.arange(1.0, 11.0, 0.0013)
    between = base.interpolated(walked.time, grid).pose
    true = Rotation.from_quat(base.pose.quaternion.copy())
    nearest = np.searchsorted(walked.time, grid).clip(max=len(true) - 1)
    error = (true[nearest].inv() * Rotation.from_quat(between.quaternion.copy())).magnitude()
    assert error.max() < 0.02  # what the base turns in a sample
    assert np.allclose(np.linalg.norm(between.quaternion, axis=1), 1.0)


@pytest.mark.parametrize("up", [(0.0, 0.0, 2.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.3, -0.5, -0.2), (0.0, 0.0, -1.0)])
def test_a_laboratory_is_turned_upright_by_a_rotation(up):
    turn = turn_upright(up)
    assert np.allclose(turn @ turn.T, np.eye(3), atol=1e-14)
    assert np.isclose(np.linalg.det(turn), 1.0)
    assert np.allclose(turn @ up, (0.0, 0.0, np.linalg.norm(up)))


def test_wrenches_of_the_laboratory_need_the_pose_of_a_base_that_moves():
    walked = walk().recording()
    force = np.tile([0.0, 0.0, 300.0], (len(walked), 1))
    of_lab = {"left_foot": Wrench(force, 0.0 * force, axes="world")}
    with pytest.raises(ExoidError, match="an IMU does not give the pose of the base") as error:
        dataclasses.replace(walked, wrenches=of_lab)
    assert "base_qx" in error.value.for_command()
    still = dataclasses.replace(walked, base=None, wrenches=of_lab)
    assert still.wrenches["left_foot"].axes == "world"
    position, turn = walk().pose
    posed = dataclasses.replace(walked.base, pose=BasePose(position, turn.as_quat()))
    moving = dataclasses.replace(walked, base=posed, wrenches=of_lab)
    assert np.array_equal(moving.slice(20, 60).base.pose.columns, posed.pose.columns[20:60])


def test_a_pose_that_contradicts_the_imu_or_jumps_is_refused():
    walked = walk().recording()
    position, turn = walk().pose
    given, row = turn.as_quat(), np.arange(len(position))[:, None]

    def posed(position, quaternion):
        pose = BasePose(position, quaternion)
        return dataclasses.replace(walked, base=dataclasses.replace(walked.base, pose=pose))

    assert posed(position, given).base.pose is not None
    for words, *pose in (
        ("off the vertical", position, (Rotation.from_euler("x", 90, degrees=True) * turn).as_quat()),
        ("off the vertical", position, np.roll(given, 1, axis=1)),  # w first
        ("row 30", position, np.where(row == 30, 1.5 * given, given)),
        ("row 30", position, (turn * Rotation.from_rotvec((row >= 30) * (0.0, 0.6, 0.0))).as_quat()),
        (r"row \d+", 1000.0 * position, given),
        ("9 samples", position[:9], given[:9]),
    ):
        with pytest.raises(ExoidError, match=words):
            posed(*pose)


def test_checks_average_wrenches_contacts_and_pose_with_the_angles():
    time = np.arange(8000) / 1000.0
    force = np.random.default_rng(0).normal(size=(len(time), 3)) + np.array([0.0, 0.0, 300.0])
    contact = np.sin(5.0 * time) > 0.0
    pose = BasePose(0.1 * np.sin(np.outer(time, (1.0, 2.0, 3.0))), np.tile([0.0, 0.0, 0.0, 1.0], (len(time), 1)))
    fast = Recording(
        time,
        0.3 * np.sin(time)[:, None],
        joint_names=("knee",),
        base=BaseMotion(np.zeros((len(time), 3)), np.tile([0.0, 0.0, 9.81], (len(time), 1)), pose=pose),
        wrenches={"left_foot": Wrench(force, 0.0 * force, axes="world")},
        contacts={"left_foot": contact},
    )
    slow = averaged(fast, ZeroPhase(4.0))
    size = len(fast) // len(slow)
    assert size > 1
    for mean, all_of_them in (
        (slow.wrenches["left_foot"].force, force),
        (slow.base.pose.position, pose.position),
        (slow.contacts["left_foot"], contact),
    ):
        groups = all_of_them[: len(slow) * size].reshape(len(slow), size, -1)
        expected = groups.all(axis=1)[:, 0] if mean.dtype == bool else groups.mean(axis=1)
        assert np.allclose(mean, expected)
