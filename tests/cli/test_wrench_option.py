"""Wrenches in logs on the command line: their columns, units and axes."""

import numpy as np
import pytest
from log_writers import named_columns, write_columns
from walking import Walk

import exoid
from exoid.cli.inputs import LogOptions, read_log

COLUMNS = [
    f"wrench_rail_{part}=rail_{part}:{'kN' if part[0] == 'f' else 'N·mm'}" for part in exoid.signals.wrench.WRENCH_PARTS
]


@pytest.fixture
def log(tmp_path):
    """A log of a swinging leg, whose hand rail writes kN and N·mm under its own names."""
    recording = Walk(exoid.load_leg("cuhk"), seconds=20.0).recording()
    wrench = np.random.default_rng(0).normal(size=(len(recording), 6)) * [0.03, 0.03, 0.1, 4e3, 4e3, 1e3]
    names = [column.partition("=")[2].partition(":")[0] for column in COLUMNS]
    logged = named_columns(recording)
    path = write_columns(tmp_path / "walk.csv", **logged, **dict(zip(names, wrench.T, strict=True)))
    return path, wrench


def test_axes_point_and_units_of_a_wrench_are_options(log):
    path, written = log
    read = read_log(str(path), LogOptions(column=COLUMNS, wrench=["rail:world@0,0.5,1"])).wrenches["rail"]
    assert read.axes == "world"
    assert read.point.tolist() == [0.0, 0.5, 1.0]
    assert np.allclose(read.columns, written * [1e3, 1e3, 1e3, 1e-3, 1e-3, 1e-3])


@pytest.mark.parametrize("verb", ["check", "select"])
def test_a_header_is_read_once(exoid_, log, verb):
    """As test_refused_options has it for identify."""
    columns = [part for column in [*COLUMNS, "wrench_belt_fx=rail_fx"] for part in ("--column", column)]
    assert "column 'rail_fx' is to be read as" in exoid_(verb, "cuhk", log[0], *columns).err
