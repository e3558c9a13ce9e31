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


def write(path, names, columns):
    rows = [",".join(map(repr, row)) for row in np.column_stack(columns).tolist()]
    path.write_text("\n".join([",".join(names), *rows]))


def test_units_scales_and_zeros_give_the_estimate_of_the_same_log_in_si(exoid_, recording, tmp_path):
    recording.to_csv(tmp_path / "si.csv")
    names, columns, options = ["stamp"], [1e3 * recording.time], ["--column", "time=stamp:ms"]
    for k, joint in enumerate(recording.joint_names):
        names += [f"enc{k}", f"cur:{k}"]
        columns += [np.rad2deg(recording.q[:, k]), 2.5 - recording.tau[:, k] / 0.118]
        options += ["--column", f"q_{joint}=enc{k}:deg", "--column", f"tau_{joint}=cur:{k}:-0.118:2.5"]
    write(tmp_path / "raw.csv", names, columns)
    expected, found = values(exoid_, "si.csv"), values(exoid_, "raw.csv", *options)
    np.testing.assert_allclose(list(found.values()), list(expected.values()), rtol=1e-5, atol=1e-6)


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
