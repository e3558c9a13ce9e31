"""Temperatures of joints are read, written, selected and resampled, in °C whatever their unit in the file."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import exoid
from exoid.identification.findings.sample import averaged
from exoid.identification.recording_summary import evidence
from exoid.signals import Column, ZeroPhase

TIME = np.arange(40) / 20.0
NAMES = ("hip", "knee")
NOTHING = np.full(40, np.nan)
WARMING = 25.0 + 10.0 * (1.0 - np.exp(-TIME))


def recording(**given):
    return exoid.Recording(time=TIME, q=np.zeros((40, 2)), joint_names=NAMES, **given)


def table(path, header, *columns):
    values = np.column_stack([TIME, np.zeros((40, 2)), *columns])
    np.savetxt(path, values, delimiter=",", header=f"time,q_hip,q_knee,{header}", comments="", encoding="utf-8")
    return path


def test_they_are_written_and_read_for_some_joints(tmp_path):
    given = recording(temperature=np.column_stack([NOTHING, WARMING]))
    given.to_csv(tmp_path / "log.csv")
    header = (tmp_path / "log.csv").read_text(encoding="utf-8").partition("\n")[0]
    assert header == "time,q_hip,q_knee,temp_knee"
    again = exoid.Recording.from_csv(tmp_path / "log.csv")
    np.testing.assert_array_equal(again.temperature, given.temperature)
    np.testing.assert_array_equal(again.select(("knee",)).temperature, given.temperature[:, 1:])
    np.testing.assert_array_equal(again.between(0.5, 1.5).temperature, given.temperature[10:30])
    assert again.segments([(0.5, 1.0)]).temperature is not None
    faster = again.resampled(40.0)
    np.testing.assert_allclose(faster.temperature[::2, 1], WARMING, rtol=1e-12)
    assert np.isnan(faster.temperature[:, 0]).all()
    assert "temperature [°C]" in repr(again)


def test_matrices_of_a_file_have_their_name(tmp_path):
    values = np.column_stack([WARMING, WARMING + 1.0])
    np.savez(tmp_path / "log.npz", time=TIME, q=0.0 * values, temperature=values, joint_names=np.array(NAMES))
    np.testing.assert_array_equal(exoid.Recording.from_file(tmp_path / "log.npz").temperature, values)


@pytest.mark.parametrize(
    ("unit", "cells"),
    [("°C", WARMING), ("degC", WARMING), ("K", WARMING + 273.15), ("°F", 32.0 + 1.8 * WARMING)],
)
def test_every_unit_gives_the_same_temperature(tmp_path, unit, cells):
    path = table(tmp_path / "log.csv", "case", cells)
    read = exoid.Recording.from_csv(path, columns={"temp_hip": Column("case", unit=unit)})
    np.testing.assert_allclose(read.temperature[:, 0], WARMING, atol=1e-9)
    tenths = Column("case", scale=0.1, unit=unit)
    path = table(tmp_path / "tenths.csv", "case", 10.0 * cells)
    read = exoid.Recording.from_csv(path, columns={"temp_hip": tenths})
    np.testing.assert_allclose(read.temperature[:, 0], WARMING, atol=1e-9)


def test_one_sensor_may_serve_several_joints(tmp_path):
    path = table(tmp_path / "log.csv", "case", WARMING)
    read = exoid.Recording.from_csv(path, columns={"temp_hip": "case", "temp_knee": "case"})
    np.testing.assert_array_equal(read.temperature[:, 0], read.temperature[:, 1])
    with pytest.raises(exoid.ExoidError, match="different header"):
        exoid.Recording.from_csv(path, columns={"temp_hip": "case", "i_hip": "case"})


def test_a_header_in_kelvins_is_not_read_as_degrees_in_silence(tmp_path):
    path = table(tmp_path / "log.csv", "case [K]", WARMING + 273.15)
    with pytest.raises(exoid.ExoidError, match="says K"):
        exoid.Recording.from_csv(path, columns={"temp_hip": "case [K]"})
    with pytest.raises(exoid.ExoidError, match="not a unit of torque"):
        exoid.Recording.from_csv(path, columns={"tau_hip": Column("case [K]", unit="K")})


def test_they_count_in_the_hash_and_in_the_average():
    given = recording(temperature=np.column_stack([NOTHING, WARMING]))
    other = dataclasses.replace(given, temperature=given.temperature + 1.0)
    assert evidence(given).sha256 != evidence(other).sha256
    time = np.arange(8000) / 2000.0
    fast = exoid.Recording(time, 0.1 * np.sin(time)[:, None], joint_names=("hip",), temperature=20.0 + time[:, None])
    mean = averaged(fast, ZeroPhase(5.0))
    assert len(mean) < len(fast)
    np.testing.assert_allclose(mean.temperature[:, 0], 20.0 + mean.time, atol=1e-9)
