"""Base motion in recordings: sensors, poses, files, and the mistakes that logs of an IMU have."""

from dataclasses import replace

import numpy as np
import pytest
from log_writers import write_columns
from scipy.spatial.transform import Rotation
from walking import IMU, Walk

import exoid
from exoid import BaseMotion, ExoidError, Recording
from exoid.signals import FiniteDifference, MovingAverage, Smoothed, ZeroPhase, choose_preparation
from exoid.signals.moving_base import base_during, vertical

LEG = exoid.load_leg("cuhk")
UPRIGHT = np.array([0.0, 0.0, 9.81])


def walk(**settings):
    return Walk(LEG, **{"seconds": 12.0, **settings})


def with_base(recording, gyro=None, force=None, position=None):
    base = recording.base
    changed = BaseMotion(
        base.angular_velocity if gyro is None else gyro,
        base.specific_force if force is None else force,
        base.position if position is None else position,
    )
    return replace(recording, base=changed)


def slow(seconds=40.0):
    """A base that tilts slowly, by 0.2 rad within seconds."""
    return Walk(LEG, seconds=seconds, rate=100.0, frequency=0.12, pitch=0.15, sideways=0.15)


# --- Sensors and poses ----------------------------------------------------------------------------------------------


def test_a_mounting_turns_readings_into_the_axes_of_the_base():
    rng = np.random.default_rng(0)
    turn = Rotation.from_rotvec([0.3, -1.2, 2.0])
    gyro, force = rng.normal(size=(2, 20, 3))
    base = BaseMotion.from_imu(turn.inv().apply(gyro), turn.inv().apply(force), rotation=turn.as_matrix(), position=IMU)
    assert np.allclose(base.angular_velocity, gyro, atol=1e-14)
    assert np.allclose(base.specific_force, force, atol=1e-14)
    assert np.array_equal(base.position, IMU)


@pytest.mark.parametrize("preparation", [ZeroPhase(8.0), Smoothed(16.0), FiniteDifference()])
def test_the_motion_at_the_root_link_follows_from_a_sensor_elsewhere(preparation):
    walked = walk(sideways=0.1)
    found, true = base_during(walked.recording(noise=0.0), preparation), walked.base
    inner = slice(100, -100)
    for name, tolerance in (("angular_velocity", 2e-3), ("angular_acceleration", 0.02), ("specific_force", 0.02)):
        error = (getattr(found, name) - getattr(true, name))[inner]
        assert np.sqrt(np.mean(error**2)) < tolerance, name


def test_the_base_has_the_delay_that_the_angles_have():
    recording = walk().recording(noise=0.0)
    angle = recording.base.angular_velocity
    twin = Recording(recording.time, angle, joint_names=("x", "y", "z"))
    average = MovingAverage(0.2)
    assert np.array_equal(base_during(recording, average).angular_velocity, average.kinematics(twin).q)


def test_poses_of_motion_capture_give_what_an_imu_measures():
    walked = walk(sideways=0.1)
    position, turn = walked.pose
    marker = position + turn.apply(IMU)
    flipped = turn.as_quat() * np.where(np.arange(len(position)) % 3, 1.0, -1.0)[:, None]  # q and −q are one turn
    base = BaseMotion.from_pose(marker, flipped, walked.time, at=IMU)
    true = walked.base
    assert np.abs(base.angular_velocity - true.angular_velocity)[50:-50].max() < 5e-3
    assert np.abs(base.specific_force - true.specific_force_at(IMU))[50:-50].max() < 0.05


def test_the_vertical_follows_the_gyroscope_in_a_walk():
    walked = walk(sideways=0.1)
    true = walked.pose[1].inv().apply([0.0, 0.0, 1.0])
    assert np.abs(true - true.mean(axis=0)).max() > 0.2
    assert np.abs(vertical(walked.recording()) - true).max() < 0.03


# --- Recordings -----------------------------------------------------------------------------------------------------


def test_the_base_is_sliced_selected_and_resampled_with_the_rest():
    recording = walk().recording()
    columns = recording.base.columns
    assert np.array_equal(recording.slice(10, 50).base.columns, columns[10:50])
    between = recording.between(2.0, 5.0)
    assert np.array_equal(between.base.columns, columns[np.searchsorted(recording.time, 2.0) :][: len(between)])
    assert np.array_equal(recording.select(("left_knee",)).base.columns, columns)
    assert np.array_equal(recording.segments([(1.0, 2.0)]).base.columns, columns)
    whole = walk(rate=400.0).recording(noise=0.0)
    kept = np.arange(len(whole)) % 9 != 7
    lossy = replace(whole, time=whole.time[kept], q=whole.q[kept], tau=whole.tau[kept], base=whole.base.rows(kept))
    found, rows = lossy.resampled().base, slice(50, -50)
    assert np.abs(found.columns[rows] - whole.base.columns[: len(found)][rows]).max() < 0.01
    assert np.array_equal(found.position, IMU)
    assert "moving base" in repr(recording)


def test_a_csv_log_keeps_the_base_and_where_its_sensor_is(tmp_path):
    recording = walk().recording()
    recording.to_csv(tmp_path / "walk.csv")
    read = Recording.from_csv(tmp_path / "walk.csv")
    assert np.array_equal(read.base.columns, recording.base.columns)
    assert np.array_equal(read.base.position, IMU)
    assert not Recording.from_csv(tmp_path / "walk.csv", base_position=(0.0, 0.0, 0.0)).base.position.any()


def test_a_log_may_have_the_pose_of_the_base(tmp_path):
    walked = walk()
    recording = walked.recording()
    position, turn = walked.pose
    names = ["time", "q_left_hip", "q_left_knee", "base_x", "base_y", "base_z", *(f"base_q{axis}" for axis in "xyzw")]
    table = np.column_stack([recording.time, recording.q, position, turn.as_quat()])
    write_columns(tmp_path / "log.csv", **dict(zip(names, table.T, strict=True)))
    read = Recording.from_csv(tmp_path / "log.csv")
    assert np.array_equal(read.base.columns, BaseMotion.from_pose(position, turn.as_quat(), walked.time).columns)


def test_the_cut_off_falls_with_a_noisy_gyroscope():
    quiet = walk(seconds=30.0).recording()
    rng = np.random.default_rng(1)
    loud = with_base(quiet, gyro=quiet.base.angular_velocity + 0.2 * rng.standard_normal((len(quiet), 3)))
    assert choose_preparation([loud]).cutoff < choose_preparation([quiet]).cutoff
    assert choose_preparation([quiet]) == choose_preparation([replace(quiet, base=None)])


# --- Mistakes -------------------------------------------------------------------------------------------------------


def refused(match, **changes):
    with pytest.raises(ExoidError, match=match) as error:
        with_base(walk().recording(), **changes)
    return error.value


def test_an_accelerometer_in_g_or_without_gravity_or_upside_down_is_refused():
    force = walk().recording().base.specific_force
    assert "it is in g" in refused("gravity alone is 9.81", force=force / 9.81).remedy
    assert "contains gravity" in refused("gravity alone is 9.81", force=(force - UPRIGHT) / 10.0).remedy
    assert "m/s²" in refused("gravity alone is 9.81", force=1e3 * force).remedy
    assert "negative scale" in refused("upside down", force=-force).remedy


def test_a_gyroscope_in_degrees_is_refused_of_a_walk_and_of_slow_motion():
    assert "rad/s" in refused("deg/s", gyro=np.rad2deg(walk(pitch=0.2).recording().base.angular_velocity)).remedy
    recording = slow().recording()
    gyro = np.rad2deg(recording.base.angular_velocity)
    assert np.sqrt(np.mean(np.sum(gyro**2, axis=1))) < 15.0
    with pytest.raises(ExoidError, match=r"5[5-9] times slower"):
        with_base(recording, gyro=gyro)


@pytest.mark.parametrize(("axis", "name"), [(0, "x"), (1, "y")])
def test_an_axis_of_the_wrong_sign_is_refused_in_slow_motion(axis, name):
    recording = slow().recording()
    sign = np.ones(3)
    sign[axis] = -1.0
    with pytest.raises(ExoidError, match=f"about {name} against"):
        with_base(recording, gyro=recording.base.angular_velocity * sign)


@pytest.mark.parametrize("radius", [-2.0, -0.5, -0.3, 0.3, 1.0])
@pytest.mark.parametrize("frequency", [0.3, 0.7, 1.5, 2.5])
def test_a_base_that_turns_about_a_point_above_its_sensor_is_not_taken_for_a_wrong_axis(radius, frequency):
    """Its sensor accelerates against gravity's turn, so that the specific force leans the other way."""
    time = np.arange(6000) / 200.0
    w = 2.0 * np.pi * frequency
    size = min(0.05, 5.0 / (abs(radius) * w**2))
    angle, rate, slope = size * np.sin(w * time), size * w * np.cos(w * time), -size * w**2 * np.sin(w * time)
    tangential, centripetal = slope * radius, -(rate**2) * radius
    zero = np.zeros_like(time)
    gyro = np.column_stack([zero, rate, zero])
    force = np.column_stack([tangential - 9.81 * np.sin(angle), zero, centripetal + 9.81 * np.cos(angle)])
    rng = np.random.default_rng(0)
    base = BaseMotion(gyro + 0.005 * rng.normal(size=gyro.shape), force + 0.05 * rng.normal(size=gyro.shape))
    Recording(time, 0.1 * np.sin(time)[:, None], joint_names=("knee",), base=base)


def pose():
    walked = walk(seconds=3.0)
    position, turn = walked.pose
    return {"position": position, "quaternion": turn.as_quat(), "time": walked.time}
