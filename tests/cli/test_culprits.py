"""Errors of the command name all that is wrong at once, and what is full."""

import os

import numpy as np
import pytest
from processes import full_disk

import exoid
from exoid.regression.row_data import RowsFile
from exoid.signals import Recording


def test_all_torque_channels_that_are_dead_are_named_at_once(exoid_, tmp_path, data):
    tau = data.train.tau.copy()
    tau[:, 0], tau[:, 2] = 0.0, 1.5
    names = data.train.joint_names
    Recording(data.train.time, data.train.q, tau=tau, joint_names=names).to_csv(tmp_path / "log.csv")
    line = exoid_("identify", "bleex", "log.csv").refusal
    for joint, value in ((names[0], 0), (names[2], 1.5)):
        assert f"the torque of joint {joint} is {value:g} N·m" in line
    assert f"tau_{names[0]}, tau_{names[2]}" in line


@pytest.mark.skipif(os.name != "posix", reason="limits of POSIX")
def test_a_full_folder_of_temporary_files_is_named(tmp_path, monkeypatch):
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    with full_disk(), pytest.raises(exoid.ExoidError) as caught:
        RowsFile(np.zeros(100_000))
    assert str(caught.value) == (
        f"{tmp_path}: temporary rows cannot be written: File too large. To fix it: free space there, or name "
        "another folder by the environment variable TMPDIR"
    )
