"""Motor torques and motor angles are read, written, selected and resampled like the other channels of drives."""

from __future__ import annotations

import numpy as np
import pytest

import exoid
from exoid.signals import Column

TIME = np.arange(40) / 20.0
NAMES = ("roll", "pitch")
NOTHING = np.full(40, np.nan)


def recording(**given):
    return exoid.Recording(time=TIME, q=np.zeros((40, 2)), joint_names=NAMES, **given)


def test_they_are_written_and_read_for_some_joints(tmp_path):
    given = recording(
        motor_torque=np.column_stack([np.sin(TIME), np.cos(TIME)]),
        motor_angle=np.column_stack([NOTHING, 50.0 * np.sin(TIME)]),
    )
    given.to_csv(tmp_path / "log.csv")
    header = (tmp_path / "log.csv").read_text(encoding="utf-8").partition("\n")[0]
    assert header == "time,q_roll,q_pitch,tm_roll,tm_pitch,qm_pitch"
    again = exoid.Recording.from_csv(tmp_path / "log.csv")
    np.testing.assert_array_equal(again.motor_torque, given.motor_torque)
    np.testing.assert_array_equal(again.motor_angle, given.motor_angle)
    assert again.tau is None
    np.testing.assert_array_equal(again.select(("pitch",)).motor_angle, given.motor_angle[:, 1:])


def test_they_have_units(tmp_path):
    path = tmp_path / "log.csv"
    table = np.column_stack([TIME, np.zeros((40, 2)), np.full(40, 1500.0), np.full(40, 180.0)])
    np.savetxt(path, table, delimiter=",", header="time,q_roll,q_pitch,motor,angle", comments="")
    columns = {"tm_roll": Column("motor", unit="N·mm"), "qm_pitch": Column("angle", unit="deg")}
    log = exoid.Recording.from_csv(path, columns=columns)
    assert log.motor_torque is not None
    np.testing.assert_allclose(log.motor_torque[:, 0], 1.5)
    np.testing.assert_allclose(log.motor_angle[:, 1], np.pi)
    with pytest.raises(exoid.ExoidError, match="not a unit of motor torque"):
        exoid.Recording.from_csv(path, columns={"tm_roll": Column("motor", unit="mA")})


def test_matrices_of_a_file_have_their_names(tmp_path):
    values = np.column_stack([np.sin(TIME), np.cos(TIME)])
    np.savez(tmp_path / "log.npz", time=TIME, q=0.1 * values, motor_torque=values, joint_names=np.array(NAMES))
    np.testing.assert_array_equal(exoid.Recording.from_file(tmp_path / "log.npz").motor_torque, values)


def test_joints_whose_torque_was_computed_stay_known():
    given = recording(tau=np.ones((40, 2)), computed=("pitch",))
    assert given.between(0.5, 1.5).computed == ("pitch",)
    assert given.select(("roll",)).computed == ()
    with pytest.raises(exoid.ExoidError, match="computed names 'yaw'"):
        recording(computed=("yaw",))
