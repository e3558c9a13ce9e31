"""Wrenches in logs on the command line: their columns, units and axes."""

import numpy as np
import pytest
from typer.testing import CliRunner
from walking import Walk

import exoid
from exoid import ExoidError
from exoid.cli import app
from exoid.cli.inputs import LogOptions, read_log

COLUMNS = [
    f"wrench_rail_{part}=rail_{part}:{'kN' if part[0] == 'f' else 'N·mm'}" for part in exoid.signals.wrench.WRENCH_PARTS
]


def run(*arguments):
    return CliRunner().invoke(app, [str(each) for each in arguments])


@pytest.fixture
def log(tmp_path):
    """A log of a swinging leg, whose hand rail writes kN and N·mm under its own names."""
    recording = Walk(exoid.load_leg("cuhk"), seconds=20.0).recording()
    wrench = np.random.default_rng(0).normal(size=(len(recording), 6)) * [0.03, 0.03, 0.1, 4e3, 4e3, 1e3]
    names = ["time", *(f"{kind}_{joint}" for kind in ("q", "tau") for joint in recording.joint_names)]
    names += [column.partition("=")[2].partition(":")[0] for column in COLUMNS]
    table = np.column_stack([recording.time, recording.q, recording.tau, wrench])
    np.savetxt(tmp_path / "walk.csv", table, delimiter=",", header=",".join(names), comments="", fmt="%.12g")
    return tmp_path / "walk.csv", wrench


def test_axes_point_and_units_of_a_wrench_are_options(log):
    path, written = log
    read = read_log(str(path), LogOptions(column=COLUMNS, wrench=["rail:world@0,0.5,1"])).wrenches["rail"]
    assert read.axes == "world"
    assert read.point.tolist() == [0.0, 0.5, 1.0]
    assert np.allclose(read.columns, written * [1e3, 1e3, 1e3, 1e-3, 1e-3, 1e-3])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (["--wrench", "rail"], "--wrench 'rail' does not say the axes"),
        (["--wrench", "rail:floor"], "--wrench 'floor' is no axes"),
        (["--wrench", "rail:link", "--wrench", "rail:world"], "rail is given twice"),
        (["--wrench", "belt:link"], "axes of the wrench on belt, which the log does not have"),
        (["--column", "wrench_belt_fx=rail_fx"], "column 'rail_fx' is to be read as"),
    ],
)
@pytest.mark.parametrize("verb", ["check", "identify", "select"])
def test_what_is_wrong_with_a_wrench_is_said(log, wrong, said, verb, tmp_path):
    path, _ = log
    columns = [part for column in COLUMNS for part in ("--column", column)]
    output = [] if verb == "check" else ["-o", tmp_path / "est.json"]
    refused = run(verb, "cuhk", path, *output, *columns, *wrong)
    assert isinstance(refused.exception, ExoidError), refused.output
    assert said in refused.exception.for_command()
