"""What drives measure (currents, forces, motor torques and angles) is kept, read and written alike."""

import dataclasses

import numpy as np
import pytest
from log_writers import write_columns

from exoid.signals import Recording

TIME = np.arange(40) / 20.0
NAMES = ("hip", "knee")
NOTHING = np.full(40, np.nan)
CHANNELS = {
    "current": ("i", 3.0 + np.sin(9.0 * TIME), "mA", 1e3, 0.0),
    "force": ("f", 500.0 * np.cos(7.0 * TIME), "kN", 1e-3, 0.0),
    "motor_torque": ("tm", np.sin(TIME), "N·mm", 1e3, 0.0),
    "motor_angle": ("qm", 50.0 * np.sin(TIME), "deg", 180.0 / np.pi, 0.0),
}
"""Prefix of the columns, values in SI, another unit, and reading in it: factor times value plus zero."""


@pytest.fixture(params=CHANNELS)
def channel(request):
    return request.param, *CHANNELS[request.param]


def recording(**given):
    return Recording(time=TIME, q=np.zeros((40, 2)), joint_names=NAMES, **given)


def test_a_channel_of_one_joint_is_written_read_sliced_selected_and_resampled(channel, tmp_path):
    name, prefix, values, *_ = channel
    given = recording(**{name: np.column_stack([NOTHING, values])})
    given.to_csv(tmp_path / "log.csv")
    header = (tmp_path / "log.csv").read_text(encoding="utf-8").partition("\n")[0]
    assert header == f"time,q_hip,q_knee,{prefix}_knee"
    both = getattr(given, name)
    again = Recording.from_csv(tmp_path / "log.csv")
    np.testing.assert_array_equal(getattr(again, name), both)
    assert again.tau is None
    np.testing.assert_array_equal(getattr(given.select(("knee",)), name), both[:, 1:])
    assert getattr(given.select(("hip",)), name) is None  # its only column was not measured
    np.testing.assert_array_equal(getattr(given.between(0.5, 1.5), name), both[10:30])
    uneven = dataclasses.replace(given, time=TIME + 0.01 * np.sin(TIME))
    even = getattr(uneven.resampled(), name)
    np.testing.assert_allclose(
        even[:, 1], np.interp(uneven.resampled().time, uneven.time, values), atol=0.01 * np.ptp(values)
    )
    assert np.isnan(even[:, 0]).all()
    assert f"{name} [" in repr(given)
    assert not both.flags.writeable


@pytest.mark.parametrize("kind", ["csv", "npz", "mat", "parquet"])
def test_every_format_has_columns_of_it(channel, kind, tmp_path):
    name, prefix, values, *_ = channel
    columns = {"time": TIME, "q_hip": 0.1 * TIME, "q_knee": 0.2 * TIME, f"{prefix}_knee": values}
    read = Recording.from_file(write_columns(tmp_path / f"log.{kind}", **columns))
    np.testing.assert_allclose(getattr(read, name)[:, 1], values, rtol=1e-15)
    assert np.isnan(getattr(read, name)[:, 0]).all()


@pytest.mark.parametrize("kind", ["npz", "mat"])
def test_a_matrix_has_the_name_of_the_quantity_or_of_its_columns(channel, kind, tmp_path):
    name, prefix, values, *_ = channel
    both = np.column_stack([values, values + 1.0])
    for title in (name, prefix):
        path = write_columns(tmp_path / f"{title}.{kind}", time=TIME, q=np.zeros((40, 2)), **{title: both})
        np.testing.assert_array_equal(getattr(Recording.from_file(path, NAMES), name), both)


def test_a_matrix_of_another_width_is_no_force_of_the_joints(tmp_path):
    np.savez(tmp_path / "plate.npz", time=TIME, q=np.zeros((40, 2)), force=np.ones((40, 6)), joint_names=NAMES)
    assert Recording.from_file(tmp_path / "plate.npz").force is None
