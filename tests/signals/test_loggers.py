"""Logs of one actuator: written as public code writes them, in its units, and read in SI."""

from __future__ import annotations

import csv
import math

import numpy as np
import pytest

import exoid
from exoid import ExoidError, Recording
from exoid.signals import Column

ACTPACK = [
    "rigid", "id", "state_time", "accelx", "accely", "accelz", "gyrox", "gyroy",
    "gyroz", "mot_ang", "mot_vel", "mot_acc", "mot_cur", "mot_volt", "batt_volt", "batt_curr",
    "temperature", "status_mn", "status_ex", "status_re", "genvar_0", "genvar_1", "genvar_2", "genvar_3",
    "genvar_4", "genvar_5", "genvar_6", "genvar_7", "genvar_8", "genvar_9", "ank_ang", "ank_vel",
    "SystemTime",
]  # fmt: skip
"""Fields of ActPackState in their order: DephyInc/Actuator-Package, ActPackState.py at commit 1b035be, all whole."""

MOTEUS = ["time", "MODE", "POSITION", "VELOCITY", "TORQUE", "VOLTAGE", "TEMPERATURE", "FAULT"]
"""Header of csv_output.py, mjbots/moteus at commit 4496cc9, for the registers that are queried by default:
``QueryResolution`` of lib/python/moteus/moteus.py, the same at commits 029e82c (integers) and 9756fc0 (floats)."""

OPENEXO = [
    "epoch", "mark", "Unused", "Ankle Angle", "Unused", "Measured Torque (R)", "Unused", "Unused",
    "Toe FSR (R)", "Heel FSR (R)", "Channel 8", "Exoskeleton time (seconds)",
]  # fmt: skip
"""Header of naubiomech/OpenExo, Python_GUI/Saved_Data/trial_20260226_151930.csv at commit e8cefd0: epoch, mark, and ten
titles of ExoCode/src/PlottingTitles.h at commit 0bff1c5. MainWindow.py at commit 0e9b70b
writes them, with six decimals."""

TIME = np.arange(500) / 250.0
ANGLE = 0.6 * np.sin(2.0 * np.pi * TIME)
VELOCITY = 0.6 * 2.0 * np.pi * np.cos(2.0 * np.pi * TIME)
TORQUE = 3.0 * np.sin(2.0 * np.pi * TIME + 0.4)


def write(path, header, rows):
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, header, restval=0)
        writer.writeheader()
        writer.writerows(rows)
    return path


@pytest.fixture
def dephy(tmp_path):
    """A minute after the device was switched on: counts of 16 384 a revolution, deg/s, mA, °C and ms."""
    rows = [
        {
            "state_time": round(60_000 + 1e3 * t),
            "mot_ang": round(50.0 * q / (2.0 * math.pi) * 16384),
            "mot_vel": round(math.degrees(50.0 * v)),
            "mot_cur": round(1e3 * tau / (50.0 * 0.1133)),
            "ank_ang": round(q / (2.0 * math.pi) * 16384),
            "ank_vel": 7,
            "temperature": 31,
        }
        for t, q, v, tau in zip(TIME, ANGLE, VELOCITY, TORQUE, strict=True)
    ]
    return write(tmp_path / "dephy.csv", ACTPACK, rows)


@pytest.fixture
def moteus(tmp_path):
    """Revolutions, revolutions per second and newton metres at the output shaft."""
    rows = [
        {
            "time": t + 1e-3,
            "MODE": 10,
            "POSITION": round(q / (2.0 * math.pi), 4),
            "VELOCITY": v / (2.0 * math.pi),
            "TORQUE": round(tau, 2),
            "VOLTAGE": 24.0,
            "TEMPERATURE": 28.0,
        }
        for t, q, v, tau in zip(TIME, ANGLE, VELOCITY, TORQUE, strict=True)
    ]
    return write(tmp_path / "moteus.csv", MOTEUS, rows)


@pytest.fixture
def openexo(tmp_path):
    """As OpenExo sends them: hundredths of every quantity, so that the clock of 111 Hz repeats some of its stamps."""
    path = tmp_path / "openexo.csv"
    return write_openexo(path, OPENEXO, 26.15 + np.arange(500) * 0.009, np.rad2deg(ANGLE), TORQUE)


def write_openexo(path, titles, clock, angle, torque):
    """Write epoch [s], mark, and the ten values of a frame, each a hundredth of a whole number, with six decimals."""
    values = {"Exoskeleton time (seconds)": clock, "Ankle Angle": angle}
    values |= {title: torque for title in titles if title.startswith("Measured Torque")}
    columns = [np.round(100.0 * np.asarray(values.get(title, 0.0 * clock))) / 100.0 for title in titles[2:]]
    lines = [
        ",".join([f"{1772144371.75 + 0.03 * (k // 3):.6f}", "0", *(f"{value:.6f}" for value in row)])
        for k, row in enumerate(zip(*columns, strict=True))
    ]
    path.write_text("\n".join([",".join(titles), *lines]) + "\n", encoding="utf-8")
    return path


def test_an_actpack_is_read_in_si(dephy):
    log = Recording.from_file(dephy, format="dephy:knee")
    assert log.joint_names == ("knee",)
    np.testing.assert_allclose(log.time, 60.0 + TIME, atol=1e-9)
    np.testing.assert_allclose(log.q[:, 0], ANGLE, atol=math.pi / 16384)
    np.testing.assert_allclose(log.motor_angle[:, 0], 50.0 * ANGLE, atol=math.pi / 16384)
    np.testing.assert_allclose(log.current[:, 0], TORQUE / (50.0 * 0.1133), atol=0.5e-3)
    np.testing.assert_array_equal(log.temperature, 31.0)
    assert log.v is None  # programs disagree on the unit of ank_vel


def test_a_moteus_is_read_in_si(moteus):
    log = Recording.from_file(moteus, format="moteus:hip")
    assert log.joint_names == ("hip",)
    np.testing.assert_allclose(log.q[:, 0], ANGLE, atol=math.pi * 1e-4)
    np.testing.assert_allclose(log.v[:, 0], VELOCITY, atol=1e-12)
    np.testing.assert_allclose(log.tau[:, 0], TORQUE, atol=0.005)


def test_an_openexo_trial_is_read_in_si_without_repeated_stamps(openexo):
    log = Recording.from_file(openexo, format="openexo-right:ankle")
    clock = np.round(26.15 + np.arange(500) * 0.009, 2)
    rows = np.flatnonzero(np.diff(clock, prepend=0.0))
    assert len(rows) < 500
    np.testing.assert_array_equal(log.time, clock[rows])
    np.testing.assert_allclose(log.q[:, 0], ANGLE[rows], atol=math.radians(0.0051))
    np.testing.assert_allclose(log.tau[:, 0], TORQUE[rows], atol=0.0051)
    assert log.v is None


def test_an_openexo_trial_of_two_sides_needs_the_side(tmp_path):
    titles = [title.replace("Channel 8", "Measured Torque (L)") for title in OPENEXO]
    path = write_openexo(tmp_path / "both.csv", titles, 26.15 + 5.0 * TIME, np.rad2deg(ANGLE), TORQUE)
    with pytest.raises(ExoidError, match=r'openexo-left or openexo-right.*format="openexo-left:ankle"'):
        Recording.from_file(path, ["ankle"])
    np.testing.assert_allclose(Recording.from_file(path, format="openexo-left:ankle").tau[:, 0], TORQUE, atol=0.0051)


@pytest.mark.parametrize(("fixture", "name"), [("dephy", "dephy"), ("moteus", "moteus"), ("openexo", "openexo-right")])
def test_the_header_tells_the_format_where_one_joint_is_asked_for(fixture, name, request):
    path = request.getfixturevalue(fixture)
    told, named = Recording.from_file(path, ["knee"]), Recording.from_file(path, format=f"{name}:knee")
    np.testing.assert_array_equal(told.q, named.q)
    with pytest.raises(ExoidError, match=rf'one actuator \({name}\).*format="{name}:knee"'):
        Recording.from_file(path)


def test_sign_and_zero_of_an_encoder_are_the_users(dephy):
    column = Column("ank_ang", scale=-1.0 / 16384, zero=0.25 * 16384 / (2.0 * math.pi), unit="rev")
    log = Recording.from_file(dephy, columns={"q_knee": column}, format="dephy:knee")
    np.testing.assert_allclose(log.q[:, 0], 0.25 - ANGLE, atol=math.pi / 16384)


def test_a_format_of_text_is_refused_for_other_files(tmp_path):
    np.savez(tmp_path / "log.npz", time=TIME, q=ANGLE[:, None], joint_names=["knee"])
    with pytest.raises(ExoidError, match="that of a text file"):
        Recording.from_file(tmp_path / "log.npz", format="moteus:knee")


def test_the_command_names_format_and_joint(exoid_, tmp_path):
    """A pendulum under a moteus: the leg's gravity comes back out of revolutions."""
    leg = exoid.Leg.from_dh([(0.3, 0.0, 0.0, -math.pi / 2)], "standard", ("knee",), base_rpy=(math.pi / 2, 0.0, 0.0))
    (tmp_path / "leg.urdf").write_text(leg.description.text, encoding="utf-8")
    t = np.arange(6000) / 200.0
    q = np.column_stack([0.5 * np.sin(2.0 * t) + 0.3 * np.sin(5.3 * t)])
    v, a = np.gradient(q, t, axis=0), np.gradient(np.gradient(q, t, axis=0), t, axis=0)
    tau = leg.inverse_dynamics(q, v, a) + 0.4 * v
    rows = [
        {"time": s, "MODE": 10, "POSITION": x / (2.0 * math.pi), "VELOCITY": u / (2.0 * math.pi), "TORQUE": y}
        for s, x, u, y in zip(t, q[:, 0], v[:, 0], tau[:, 0], strict=True)
    ]
    write(tmp_path / "moteus.csv", MOTEUS, rows)
    refused = exoid_("identify", "leg.urdf", "moteus.csv")
    assert "--format moteus:knee" in refused.err
    done = exoid_("identify", "leg.urdf", "moteus.csv", "--format", "moteus:knee", "-o", "est.json", "--no-check")
    assert done.code == 0, done.err
    est = exoid.Estimate.load(tmp_path / "est.json")
    assert est.value("X1") == pytest.approx(leg.parameters[0], rel=0.01)
    assert est.value("d_knee") == pytest.approx(0.4, rel=0.02)
