"""Logs of a moving base, and of wrenches, on the command line: their columns, units and axes."""

import numpy as np
import pytest
from log_writers import named_columns, write_columns
from walking import IMU, Walk

import exoid
from exoid.cli.inputs import LogOptions, read_log
from exoid.signals.base_motion import BASE_COLUMNS
from exoid.signals.wrench import WRENCH_PARTS


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


WRENCHES = [f"wrench_rail_{part}=rail_{part}:{'kN' if part[0] == 'f' else 'N·mm'}" for part in WRENCH_PARTS]


@pytest.fixture
def pushed(tmp_path):
    """A log of a swinging leg, whose hand rail writes kN and N·mm under its own names."""
    recording = Walk(exoid.load_leg("cuhk"), seconds=20.0).recording()
    wrench = np.random.default_rng(0).normal(size=(len(recording), 6)) * [0.03, 0.03, 0.1, 4e3, 4e3, 1e3]
    names = [column.partition("=")[2].partition(":")[0] for column in WRENCHES]
    logged = named_columns(recording)
    path = write_columns(tmp_path / "walk.csv", **logged, **dict(zip(names, wrench.T, strict=True)))
    return path, wrench


def test_axes_point_and_units_of_a_wrench_are_options(pushed):
    path, written = pushed
    read = read_log(str(path), LogOptions(column=WRENCHES, wrench=["rail:world@0,0.5,1"])).wrenches["rail"]
    assert read.axes == "world"
    assert read.point.tolist() == [0.0, 0.5, 1.0]
    assert np.allclose(read.columns, written * [1e3, 1e3, 1e3, 1e-3, 1e-3, 1e-3])


@pytest.mark.parametrize("verb", ["check", "select"])
def test_a_header_is_read_once(exoid_, pushed, verb):
    """As test_refused_options has it for identify."""
    columns = [part for column in [*WRENCHES, "wrench_belt_fx=rail_fx"] for part in ("--column", column)]
    assert "column 'rail_fx' is to be read as" in exoid_(verb, "cuhk", pushed[0], *columns).err
