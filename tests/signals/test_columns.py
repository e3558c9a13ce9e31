"""Currents and forces of logs; scale, zero and unit of columns; numbers behind a comment; joints without torque."""

import numpy as np
import pytest
from log_writers import write_columns

from exoid import ExoidError, Recording
from exoid.signals import Column

T = np.arange(40) / 100.0
Q = np.column_stack([0.3 * np.sin(5 * T), 0.2 * np.cos(4 * T)])
CURRENT = np.column_stack([3.0 + np.sin(9 * T), np.full(40, np.nan)])
FORCE = np.column_stack([np.full(40, np.nan), 500.0 * np.cos(7 * T)])


def recording(**changes):
    arrays = {"time": T, "q": Q, "current": CURRENT, "force": FORCE, "joint_names": ("hip", "knee")}
    return Recording(**{**arrays, **changes})


COLUMNS = {"stamp": 1000.0 * T, "enc": np.rad2deg(Q[:, 0]), "cur": 1000.0 * CURRENT[:, 0], "cur:A": CURRENT[:, 0]}


@pytest.fixture
def raw(tmp_path):
    """Milliseconds, degrees and milliamperes, under headers of a logger."""
    return write_columns(tmp_path / "raw.csv", **COLUMNS)


BASE = {"time": Column("stamp", unit="ms"), "q_hip": Column("enc", unit="deg")}


def test_a_unit_converts_a_column_to_si(raw):
    log = Recording.from_file(raw, columns={**BASE, "i_hip": Column("cur", unit="mA")})
    np.testing.assert_allclose(log.time, T, atol=1e-15)
    np.testing.assert_allclose(log.q, Q[:, :1], rtol=1e-14)
    np.testing.assert_allclose(log.current, CURRENT[:, :1], rtol=1e-14)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("cur", Column("cur")),
        ("cur:0.118", Column("cur", 0.118)),
        ("cur:-0.118:2.5", Column("cur", -0.118, 2.5)),
        ("enc:deg", Column("enc", unit="deg")),
        ("enc:0.088:2048:deg", Column("enc", 0.088, 2048.0, "deg")),
        ("torque:Nmm", Column("torque", unit="Nmm")),
        ("pos[0]:1e-3", Column("pos[0]", 1e-3)),
        ("cur:A", Column("cur", unit="A")),
        ("cur:A:1:0:A", Column("cur:A", unit="A")),
        ("pos:1:1:0", Column("pos:1")),
        ("/joints: effort", Column("/joints: effort")),
    ],
)
def test_numbers_and_a_unit_are_read_from_the_end_of_a_text(text, expected):
    assert Column.from_text(text) == expected


@pytest.mark.parametrize("unit", ["Nmm", "N·mm", "N.mm", "N mm", "mNm", "mN·m"])
def test_spellings_of_a_unit_are_one(raw, unit):
    log = Recording.from_file(raw, columns={**BASE, "tau_hip": Column("cur", unit=unit)})
    np.testing.assert_allclose(log.tau[:, 0], CURRENT[:, 0], rtol=1e-12)


def test_amperes_are_not_taken_for_torque(raw):
    with pytest.raises(ExoidError, match="its name says that it is a current") as caught:
        Recording.from_file(raw, columns={**BASE, "tau_hip": "cur"})
    assert "i_hip" in caught.value.remedy
    Recording.from_file(raw, columns={**BASE, "tau_hip": Column("cur", unit="N·m")})


@pytest.mark.parametrize(("header", "name"), [("hip [N·mm]", "tau_hip"), ("hip (mA)", "i_hip"), ("hip [deg]", "q_hip")])
def test_a_header_with_another_unit_is_not_taken_for_si(tmp_path, header, name):
    columns = {"time": T, "q_hip": Q[:, 0], header: Q[:, 1]}
    if name == "q_hip":
        del columns["q_hip"]
    path = write_columns(tmp_path / "log.csv", **columns)
    with pytest.raises(ExoidError, match="and would be read as"):
        Recording.from_csv(path, columns={name: header})
    if name == "q_hip":
        Recording.from_csv(path, columns={name: header}, angle_unit="deg")


def test_one_header_may_be_current_and_torque_of_a_joint_and_nothing_else(raw):
    both = {"i_hip": Column("cur", unit="mA"), "tau_hip": Column("cur", scale=1e-4)}
    log = Recording.from_file(raw, columns={**BASE, **both})
    np.testing.assert_allclose(log.tau, 0.1 * log.current, rtol=1e-12)
    with pytest.raises(ExoidError, match="is to be read as q_hip and v_hip"):
        Recording.from_file(raw, columns={**BASE, "v_hip": "enc"})


def test_a_comment_of_numpy_heads_columns_separated_by_spaces(tmp_path):
    np.savetxt(tmp_path / "log.txt", np.column_stack([T, Q]), header="time q_hip q_knee")
    np.testing.assert_array_equal(Recording.from_file(tmp_path / "log.txt").q, Q)


def test_a_column_without_any_entry_was_not_measured(tmp_path):
    path = tmp_path / "log.csv"
    rows = [f"{t},{a},{b},,{t}" for t, (a, b) in zip(T.tolist(), Q.tolist(), strict=True)]
    path.write_text("\n".join(["time,q_hip,q_knee,tau_hip,tau_knee", *rows]))
    assert Recording.from_csv(path).measured.tolist() == [False, True]
    path.write_text("\n".join(["time,q_hip,q_knee,tau_hip,tau_knee", *rows[:-1], "0.39,0.1,0.1,3.0,1.0"]))
    with pytest.raises(ExoidError, match="line 2, column tau_hip: the cell is empty"):
        Recording.from_csv(path)


def test_the_torque_of_a_passive_joint_is_zero():
    log = recording(force=None, passive=("knee",))
    assert log.measured.tolist() == [False, True]
    assert not log.driven.any()
    np.testing.assert_array_equal(log.tau[:, 1], 0.0)
    assert "passive: knee" in repr(log)
    assert log.select(("knee",)).passive == ("knee",)
    assert log.select(("hip",)).passive == ()
    assert log.slice(0, 20).passive == ("knee",)
    assert recording(force=None, tau=np.full((40, 2), [0.3, np.nan]), passive=("knee",)).tau[3].tolist() == [0.3, 0.0]
