"""Logs of a moving base on the command line."""

import numpy as np
import pytest
from log_writers import named_columns, write_columns
from walking import IMU, Walk

import exoid
from exoid.signals.base_motion import BASE_COLUMNS


@pytest.fixture
def walk(tmp_path):
    """A log of a walk by an acquisition system that knows nothing of exoid: own headers, deg/s and g."""
    recording = Walk(exoid.load_leg("cuhk"), seconds=30.0).recording()
    base = recording.base.columns * np.r_[np.full(3, np.rad2deg(1.0)), np.full(3, 1.0 / 9.80665)]
    logged = named_columns(recording)
    write_columns(tmp_path / "walk.csv", **logged, **{f"imu_{n}": x for n, x in zip(BASE_COLUMNS, base.T, strict=True)})
    units = {name: "deg/s" if "gyro" in name else "g" for name in BASE_COLUMNS}
    columns = [part for name, unit in units.items() for part in ("--column", f"{name}=imu_{name}:{unit}")]
    return tmp_path / "walk.csv", [*columns, "--base-position", ",".join(map(str, IMU))]


def test_a_walk_is_identified_checked_and_validated(exoid_, walk, tmp_path):
    log, options = walk
    out = tmp_path / "est.json"
    assert exoid_("identify", "cuhk", log, "-o", out, "--terms", "none", "--no-check", *options).printed
    estimate, truth = exoid.Estimate.load(out), exoid.load_leg("cuhk").parameters
    assert np.abs(estimate.values / truth - 1.0)[[0, 2, 3, 5]].max() < 0.005
    checked = exoid_("check", "cuhk", log, "--terms", "none", *options)
    assert "nothing found" in checked.out
    assert max(exoid_("validate", out, log, "--json", *options).data["nrmse"]) < 0.03


def test_what_is_wrong_with_the_options_is_said(exoid_, walk, tmp_path):
    log, options = walk
    for wrong, said in (
        ((*options[:-2], "--base-position", "1,2"), "position"),
        (("--base-position", "0,0,0"), "no motion of the base"),
        (options[2:], "lacks base_gyro_x"),
        ((*options, "--moving-base"), "--moving-base has no effect"),
    ):
        assert said in exoid_("identify", "cuhk", log, "-o", tmp_path / "est.json", *wrong).refusal
