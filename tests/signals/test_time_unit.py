"""Time in milliseconds does not pass: it is refused where the log is read, and where it passes, J says so."""

import numpy as np
import pytest
from log_writers import write_columns
from one_joint import swing, write_urdf

from exoid.errors import UnreadableInputError
from exoid.signals import Column, Recording


@pytest.mark.parametrize("per_second", [1e3, 1e6, 1e9])
@pytest.mark.parametrize("epoch", [0.0, 1.7e9])
def test_stamps_in_another_unit_are_refused_and_read_with_it(tmp_path, per_second, epoch):
    leg = write_urdf(tmp_path / "one.urdf")
    log = swing(leg, seconds=10.0, rate=100.0)
    stamps = np.round((epoch + log.time) * per_second)
    with pytest.raises(UnreadableInputError) as error:
        Recording(stamps, log.q, tau=log.tau, joint_names=log.joint_names)
    assert error.value.column == "time"
    (joint,) = log.joint_names
    joints = {f"q_{joint}": log.q[:, 0], f"tau_{joint}": log.tau[:, 0]}
    write_columns(tmp_path / "log.csv", clock=stamps, **joints)
    with pytest.raises(UnreadableInputError) as error:
        Recording.from_csv(tmp_path / "log.csv", columns={"time": "clock"})
    assert (error.value.column, "time=HEADER:ms" in error.value.command) == ("time", True)
    unit = {1e3: "ms", 1e6: "us", 1e9: "ns"}[per_second]
    read = Recording.from_csv(tmp_path / "log.csv", columns={"time": Column("clock", unit=unit)})
    assert read.sample_rate == pytest.approx(log.sample_rate, rel=1e-3)


def test_a_slow_log_in_seconds_is_read():
    assert Recording(np.arange(20) / 4.0, np.zeros((20, 1)), joint_names=("knee",)).sample_rate == 4.0
