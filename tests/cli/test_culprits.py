"""Errors of the command name what is wrong, in words of the command line."""

from __future__ import annotations

import os
import re
import signal

import numpy as np
import pytest
from one_joint import URDF, swing, write_urdf

import exoid
from exoid.regression.row_data import RowsFile
from exoid.signals import Recording

PYTHON = re.compile(
    r"columns=|columns\[|angle_unit|topic=|stamps=|joint_names|largest_angle|np\.|math\.|pass |Recording\."
)
"""Words that a user of the command line has no use for."""


@pytest.fixture
def refused(exoid_, tmp_path):
    """Run a command in a folder with a leg, a log and logs that are wrong; return the one line of the refusal."""
    leg = write_urdf(tmp_path / "one.urdf")
    log = swing(leg, seconds=5.0)
    log.to_csv(tmp_path / "log.csv")
    text = (tmp_path / "log.csv").read_text(encoding="utf-8")
    (tmp_path / "other.csv").write_text(text.replace("q_hip", "pos").replace("tau_hip", "trq"), encoding="utf-8")
    (tmp_path / "untimed.csv").write_text(text.replace("time", "t"), encoding="utf-8")
    Recording(log.time, np.rad2deg(log.q), tau=log.tau, joint_names=("hip",), largest_angle=np.inf).to_csv(
        tmp_path / "degrees.csv"
    )
    (tmp_path / "fixed.urdf").write_text(URDF.replace('"revolute"', '"fixed"'), encoding="utf-8")

    def run(*words):
        found = exoid_(*words)
        assert (found.code, found.out) == (2, ""), found
        assert found.err.count("\n") == 1
        assert not PYTHON.search(found.err), found.err
        return found.err

    return run


@pytest.mark.parametrize("verb", ["identify", "select", "check", "plan", "view"])
def test_a_misspelt_urdf_is_blamed_and_not_the_columns_of_the_log(refused, verb):
    option = {"plan": ["--assess"], "view": ["--log"]}.get(verb, [])
    line = refused(verb, "oen.urdf", *option, "other.csv")
    assert "no leg or URDF file 'oen.urdf'. To fix it: did you mean 'one.urdf'?" in line


def test_all_torque_channels_that_are_dead_are_named_at_once(exoid_, tmp_path):
    data = exoid.datasets.bleex_swing()
    tau = data.train.tau.copy()
    tau[:, 0], tau[:, 2] = 0.0, 1.5
    names = data.train.joint_names
    Recording(data.train.time, data.train.q, tau=tau, joint_names=names).to_csv(tmp_path / "log.csv")
    run = exoid_("identify", "bleex", "log.csv")
    assert run.code == 2
    for joint, value in ((names[0], 0), (names[2], 1.5)):
        assert f"the torque of joint {joint} is {value:g} N·m" in run.err
    assert f"tau_{names[0]}, tau_{names[2]}" in run.err


@pytest.mark.skipif(os.name != "posix", reason="limits of POSIX")
def test_a_full_folder_of_temporary_files_is_named(tmp_path, monkeypatch):
    """A limit on the size of files stands for the disk."""
    resource = pytest.importorskip("resource")
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    old, handler = resource.getrlimit(resource.RLIMIT_FSIZE), signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    rows = RowsFile()
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (1024, old[1]))
        with pytest.raises(exoid.ExoidError) as caught:
            rows.add(np.zeros(100_000))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, old)
        signal.signal(signal.SIGXFSZ, handler)
    assert str(caught.value) == (
        f"{tmp_path}: temporary rows cannot be written: File too large. To fix it: free space there, or name "
        "another folder by the environment variable TMPDIR"
    )
