"""Options of the commands that say how columns of a log are to be read."""

import json

import numpy as np
import pytest

import exoid


@pytest.fixture(scope="module")
def recording():
    return exoid.datasets.bleex_swing().train


def values(exoid_, *arguments):
    code, out, err = exoid_("identify", "bleex", *arguments, "--json", "--no-check")
    assert (code, err) == (0, "")
    return json.loads(out)["values"]


def test_a_joint_without_torque_and_a_dead_channel_give_the_same_estimate(exoid_, recording, tmp_path):
    tau = np.array(recording.tau)
    tau[:, 2] = np.nan
    joints = recording.joint_names
    short = exoid.Recording(recording.time, recording.q, tau=tau, joint_names=joints)
    short.to_csv(tmp_path / "short.csv")
    tau[:, 2] = 0.0
    exoid.Recording(recording.time, recording.q, tau=tau, joint_names=joints).to_csv(tmp_path / "dead.csv")
    expected = values(exoid_, "short.csv")
    assert values(exoid_, "dead.csv", "--unmeasured", joints[2]) == expected
    code, _, err = exoid_("identify", "bleex", "dead.csv")
    assert code == 2
    assert f"--passive {joints[2]}" in err
    assert exoid_("identify", "bleex", "short.csv", "-o", "est.json", "--no-check")[0] == 0
    code, out, _ = exoid_("validate", "est.json", "short.csv")
    assert code == 0
    assert "not measured" in out
    code, out, _ = exoid_("check", "bleex", "short.csv")
    assert "unmeasured-torque" in out
