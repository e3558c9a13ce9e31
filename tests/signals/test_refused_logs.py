"""What no recording can be is refused: the kind of the error, and its evidence (row, column, file)."""

from __future__ import annotations

import dataclasses
import math
from functools import partial

import numpy as np
import pytest

from exoid import BaseMotion, ExoidError, Recording, TorsoMotion, Wrench
from exoid.errors import BadArgumentError, NotSupportedError, UnreadableInputError
from exoid.leg.payload import Payload
from exoid.signals import (
    Column,
    MovingAverage,
    ZeroPhase,
    contacts_from_switch,
    contacts_from_wrench,
    settled,
    zero_phase,
)
from exoid.signals.differentiation import central_difference, second_difference, smooth_motion

N = 60
TIME = np.arange(N) / 50.0
STEPS = np.maximum(0.0, np.sin(2.0 * np.pi * 0.9 * TIME))
PHASE = 4.0 * np.column_stack([TIME, TIME + 0.3])
GRAVITY = np.tile([0.0, 0.0, 9.81], (N, 1))
ZERO = np.zeros((N, 3))


def recording(**changes):
    q, v = 0.5 * np.sin(PHASE), 2.0 * np.cos(PHASE)
    given = {"time": TIME, "q": q, "v": v, "a": -16.0 * q, "tau": 15.0 * v, "joint_names": ("hip", "knee")}
    return Recording(**{**given, **changes})


def cell(name, row, value, joint=1):
    """The values of one quantity with another one in a cell."""
    values = TIME.copy() if name == "time" else getattr(recording(), name).copy()
    values[(row,) if name == "time" else (row, joint)] = value
    return partial(recording, **{name: values})


def foot(**changes):
    return Wrench(**{"force": np.tile([20.0, 0.0, 400.0], (N, 1)), "moment": ZERO + 1.0, **changes})


def carried(**changes):
    return partial(recording, **changes)


def base(gyro=ZERO, force=GRAVITY, position=(0.0, 0.0, 0.0)):
    return partial(BaseMotion, gyro, force, position)


def load(newtons):
    return Wrench(np.outer(newtons, (0.0, 0.0, 1.0)), np.zeros((N, 3)))


def posed(change=lambda position, quaternion, time: None, **settings):
    """Poses of a base that stands, changed in place."""
    rows = 400
    given = np.zeros((rows, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (rows, 1)), np.arange(rows) / 100.0
    changed = change(*given)
    return partial(BaseMotion.from_pose, *(given if changed is None else changed), **settings)


def put(which, where, value):
    """Write a value into position (0), quaternion (1) or time (2)."""
    return lambda *given: given[which].__setitem__(where, value)


ARGUMENTS = {
    "three columns": (carried(q=np.zeros((N, 3))), BadArgumentError, ""),
    "fewer rows": (carried(tau=np.zeros((N - 1, 2))), BadArgumentError, ""),
    "joints first": (carried(v=np.zeros((2, N))), BadArgumentError, ""),
    "one dimension": (carried(a=np.zeros(N)), BadArgumentError, ""),
    "time as a column": (carried(time=np.zeros((N, 1))), BadArgumentError, ""),
    "time as a number": (carried(time=3.0), BadArgumentError, ""),
    "no angles": (carried(q=None), BadArgumentError, ""),
    "text": (carried(q=[["a", "b"]] * N), BadArgumentError, ""),
    "complex": (carried(q=np.ones((N, 2), dtype=complex)), BadArgumentError, ""),
    "ragged": (carried(tau=[[1.0, 2.0], [3.0]]), BadArgumentError, ""),
    "dates": (carried(time=TIME.astype("datetime64[s]")), BadArgumentError, ""),
    "masked": (carried(tau=np.ma.masked_equal(np.eye(N, 2), 1.0)), UnreadableInputError, "tau_hip"),
    "overflow": (cell("tau", 3, 1e300), UnreadableInputError, "tau_knee"),
    "degrees": (cell("q", 12, -45.0), UnreadableInputError, "q_knee"),
    "repeated time": (cell("time", 31, 0.6), UnreadableInputError, ""),
    "reversed time": (cell("time", 31, 0.1), UnreadableInputError, ""),
    "nanoseconds": (carried(time=1e13 * TIME), UnreadableInputError, "time"),
    "too dense": (carried(time=1e-9 * TIME), UnreadableInputError, "time"),
    "same name": (carried(joint_names=("hip", "hip")), BadArgumentError, ""),
    "empty name": (carried(joint_names=("hip", "")), BadArgumentError, ""),
    "outer space": (carried(joint_names=("hip", " knee")), BadArgumentError, ""),
    "line break": (carried(joint_names=("hip", "kn\nee")), BadArgumentError, ""),
    "number as name": (carried(joint_names=("hip", 3)), BadArgumentError, ""),
    "delimiter in name": (carried(joint_names=("hip", "l;knee")), BadArgumentError, ""),
    "string of names": (carried(joint_names="hip"), BadArgumentError, ""),
    "no names": (carried(joint_names=()), BadArgumentError, ""),
    "limit of angles": (carried(largest_angle=math.nan), BadArgumentError, ""),
    "unknown joint": (lambda: recording().select(["hip", "ankle"]), BadArgumentError, ""),
    "empty slice": (lambda: recording().between(50.0, 60.0), BadArgumentError, ""),
    "short slice": (lambda: recording().slice(0, 9), UnreadableInputError, ""),
    "lower rate": (lambda: recording().resampled(25.0), BadArgumentError, ""),
    "infinite rate": (lambda: recording().resampled(np.inf), BadArgumentError, ""),
    "gap in current": (carried(current=np.where(np.eye(N, 2), np.nan, 1.0)), UnreadableInputError, "i_hip"),
    "milliamperes": (carried(current=np.full((N, 2), 3000.0)), UnreadableInputError, "i_hip"),
    "kelvins": (carried(temperature=np.full((N, 2), 300.0)), UnreadableInputError, "temp_hip"),
    "gap in temperature": (carried(temperature=np.where(np.eye(N, 2), np.nan, 30.0)), UnreadableInputError, "temp_hip"),
    "passive and driven": (carried(passive=("knee",)), BadArgumentError, ""),
    "passive unknown": (carried(passive=("ankle",)), BadArgumentError, ""),
    "computed unknown": (carried(computed=("yaw",)), BadArgumentError, ""),
    "mask of twos": (carried(mask=np.full(N, 2)), BadArgumentError, ""),
    "mask of text": (carried(mask=["yes"] * N), BadArgumentError, ""),
    "short mask": (carried(mask=np.ones(N - 1)), BadArgumentError, ""),
    "no segments": (lambda: recording().segments([]), BadArgumentError, ""),
    "times as segments": (lambda: recording().segments([0.1, 0.3]), BadArgumentError, ""),
    "backward segment": (lambda: recording().segments([(0.3, 0.1)]), BadArgumentError, ""),
    "endless segment": (lambda: recording().segments([(0.1, np.nan)]), BadArgumentError, ""),
    "segment beyond": (lambda: recording().segments([(5.0, 6.0)]), BadArgumentError, ""),
    "wrenches in a list": (lambda: recording(wrenches=[foot()]), BadArgumentError, ""),
    "array as wrench": (carried(wrenches={"foot": np.zeros((N, 6))}), BadArgumentError, ""),
    "short wrench": (lambda: recording(wrenches={"foot": foot().rows(slice(9))}), BadArgumentError, ""),
    "link with a comma": (lambda: recording(wrenches={"left,foot": foot()}), BadArgumentError, ""),
    "half a contact": (carried(contacts={"foot": np.full(N, 0.5)}), BadArgumentError, ""),
    "short contact": (carried(contacts={"foot": np.ones(N - 1)}), BadArgumentError, ""),
    "contact as column": (carried(contacts={"foot": np.ones((N, 1))}), BadArgumentError, ""),
    "dict as base": (carried(base={}), UnreadableInputError, ""),
    "axes of a plate": (lambda: foot(axes="plate"), BadArgumentError, ""),
    "two forces": (lambda: foot(force=np.zeros((N, 2))), BadArgumentError, ""),
    "missing moment": (lambda: foot(moment=np.full((N, 3), np.nan)), UnreadableInputError, "mx"),
    "infinite point": (lambda: foot(point=(0.0, np.inf, 0.0)), UnreadableInputError, "py"),
    "point moves in the link": (lambda: foot(point=ZERO), BadArgumentError, ""),
    "point in mm": (lambda: foot(point=(50.0, 0.0, -80.0)), UnreadableInputError, ""),
    "force in mN": (lambda: foot(force=np.full((N, 3), 4e5)), UnreadableInputError, ""),
    "moment in N·mm": (lambda: foot(moment=np.full((N, 3), 3e4)), UnreadableInputError, ""),
    "line of force far away": (
        lambda: foot(force=np.tile([0.3, 0, 0], (N, 1)), moment=np.tile([0, 9, 0], (N, 1))),
        UnreadableInputError,
        "",
    ),
    "text as force": (lambda: foot(force="much"), BadArgumentError, ""),
    "lift above touch": (lambda: contacts_from_wrench(load(800.0 * STEPS), touch=0.05, lift=0.1), BadArgumentError, ""),
    "nobody stands": (lambda: contacts_from_wrench(load(2.0 * STEPS)), BadArgumentError, ""),
    "into the ground": (lambda: contacts_from_wrench(load(-800.0 * STEPS)), BadArgumentError, ""),
    "sideways": (lambda: contacts_from_wrench(load(800.0 * STEPS), up=(1.0, 0.0, 0.0)), BadArgumentError, ""),
    "no direction": (lambda: contacts_from_wrench(load(800.0 * STEPS), up=(0.0, 0.0, 0.0)), BadArgumentError, ""),
    "always stands": (lambda: contacts_from_wrench(load(400.0 + 300.0 * STEPS)), BadArgumentError, ""),
    "never pressed": (lambda: contacts_from_switch(STEPS, 2.0, 0.5), BadArgumentError, ""),
    "never released": (lambda: contacts_from_switch(1.0 + STEPS, 1.5, 0.5), BadArgumentError, ""),
    "one threshold": (lambda: contacts_from_switch(STEPS, 0.5, 0.5), BadArgumentError, ""),
    "missing reading": (lambda: contacts_from_switch([0.0, np.nan, 1.0], 0.5, 0.2), BadArgumentError, ""),
    "no readings": (lambda: contacts_from_switch([], 0.5, 0.2), BadArgumentError, ""),
    "negative margin": (lambda: settled(STEPS > 0.0, TIME, -0.1), BadArgumentError, ""),
    "margin of others": (lambda: settled(STEPS[1:] > 0.0, TIME, 0.1), BadArgumentError, ""),
    "gyro of two": (base(gyro=np.zeros((N, 2))), BadArgumentError, ""),
    "gyro by axis": (base(gyro=np.zeros((3, N))), BadArgumentError, ""),
    "short force": (base(force=GRAVITY[1:]), BadArgumentError, ""),
    "missing gyro": (base(gyro=np.full((N, 3), np.nan)), UnreadableInputError, "base_gyro_x"),
    "infinite acceleration": (base(force=np.full((N, 3), np.inf)), UnreadableInputError, "base_acc_x"),
    "text as gyro": (base(gyro="fast"), BadArgumentError, ""),
    "sensor of two": (base(position=np.zeros(2)), BadArgumentError, ""),
    "sensor in mm": (base(position=(50.0, 0.0, 250.0)), BadArgumentError, ""),
    "sensor nowhere": (base(position=(np.nan, 0.0, 0.0)), BadArgumentError, ""),
    "mounting of two": (partial(BaseMotion.from_imu, ZERO, GRAVITY, rotation=np.eye(2)), BadArgumentError, ""),
    "mounting that scales": (
        partial(BaseMotion.from_imu, ZERO, GRAVITY, rotation=2.0 * np.eye(3)),
        BadArgumentError,
        "",
    ),
    "mirror": (partial(BaseMotion.from_imu, ZERO, GRAVITY, rotation=np.diag([1, 1, -1])), BadArgumentError, ""),
    "norm": (posed(put(1, 100, 1.1)), BadArgumentError, ""),
    "no quaternion": (posed(put(1, 100, 0.0)), BadArgumentError, ""),
    "turn jumps": (posed(put(1, (slice(100, None), slice(2, None)), 0.7071)), BadArgumentError, ""),
    "place jumps": (posed(put(0, slice(100, None), 1.0)), BadArgumentError, ""),
    "place missing": (posed(put(0, (100, 1), np.nan)), UnreadableInputError, "base_y"),
    "uneven poses": (posed(put(2, slice(100, None), np.arange(300) / 100.0 + 1.5)), BadArgumentError, ""),
    "three of four": (posed(lambda p, h, t: (p, h[:, :3], t)), BadArgumentError, ""),
    "few poses": (posed(lambda p, h, t: (p[:15], h[:15], t[:15])), BadArgumentError, ""),
    "no cut-off": (posed(cutoff=0.0), BadArgumentError, ""),
    "no vertical": (posed(up=(0.0, 0.0, 0.0)), BadArgumentError, ""),
    "scale zero": (lambda: Column("cur", scale=0.0), BadArgumentError, ""),
    "zero infinite": (lambda: Column("cur", zero=np.inf), BadArgumentError, ""),
    "scale as text": (lambda: Column("cur", scale="2"), BadArgumentError, ""),
    "unit of current for torque": (lambda: Column("c", unit="mA").read("tau_hip", TIME), UnreadableInputError, ""),
    "unit of time for angle": (lambda: Column("c", unit="ms").read("q_hip", TIME), UnreadableInputError, ""),
    "payload without place": (lambda: Payload.from_text("knee:3"), ExoidError, ""),
    "payload of words": (lambda: Payload.from_text("knee:heavy@0,0,0"), ExoidError, ""),
    "payload in grams": (lambda: Payload("hip", 3000.0), ExoidError, ""),
    "payload in mm": (lambda: Payload("hip", 1.0, (0.0, 0.0, -300.0)), ExoidError, ""),
    "half the rate": (lambda: zero_phase(ZERO, 50.0, 25.0), BadArgumentError, ""),
    "no cut-off of a filter": (lambda: zero_phase(ZERO, 50.0, np.nan), BadArgumentError, ""),
    "order": (lambda: zero_phase(ZERO, 50.0, 8.0, 1.5), BadArgumentError, ""),
    "short for its filter": (lambda: zero_phase(ZERO[:9], 50.0, 1.0), UnreadableInputError, ""),
    "short for its continuation": (lambda: smooth_motion(ZERO[:39], 200.0, 10.0), UnreadableInputError, ""),
    "short for a difference": (lambda: central_difference(ZERO[:2], 50.0), UnreadableInputError, ""),
    "short for a second one": (lambda: second_difference(ZERO[:5], 50.0, 4), UnreadableInputError, ""),
    "preparation without cut-off": (lambda: ZeroPhase(0.0), BadArgumentError, ""),
    "negative cut-off": (lambda: ZeroPhase(kinematics_cutoff=-1.0), BadArgumentError, ""),
    "weight of nothing": (lambda: MovingAverage(0.0), BadArgumentError, ""),
    "only edges": (lambda: MovingAverage(0.01).kinematics(recording()), UnreadableInputError, ""),
    "rate too low": (lambda: ZeroPhase().kinematics(recording(time=5.0 * TIME, v=None)), BadArgumentError, ""),
}


@pytest.mark.parametrize(("call", "kind", "column"), ARGUMENTS.values(), ids=ARGUMENTS)
def test_arguments_that_no_recording_can_have_are_refused(call, kind, column):
    with pytest.raises(kind) as error:
        call()
    assert error.value.column == column
    assert error.value.remedy


HEADER = "time,q_hip,q_knee,tau_hip,tau_knee"
ROWS = [f"{0.02 * k:.2f},{0.1 * math.sin(k / 9):.4f},{-0.01 * k:.2f},{k},{-k}.5" for k in range(12)]
IMU = "time,q_hip,base_gyro_x,base_gyro_y,base_gyro_z,base_acc_x,base_acc_y,base_acc_z"
FOOT = ",".join(
    ["time,q_hip", *(f"wrench_foot_{part}" for part in ("fx", "fy", "fz", "mx", "my", "mz")), "contact_foot"]
)


def changed(line, text):
    """A good log with one line (counted from 1) replaced."""
    lines = [HEADER, *ROWS]
    lines[line - 1] = text
    return "\n".join(lines).encode()


def table(header, row, count=12, above=()):
    return "\n".join([*above, header, *(f"{0.02 * k:.2f},{row}" for k in range(count))]).encode()


GOOD = changed(1, HEADER)
CELL = "log.csv, line 5, column tau_hip"
STANDS = "0.1,0,0,500,0,0,0,1"

LOGS = {
    "empty": (b"", {}, UnreadableInputError, "log.csv"),
    "blank": (b"\n  \r\n", {}, UnreadableInputError, "log.csv"),
    "comments": (b"# nothing here\n", {}, UnreadableInputError, "log.csv"),
    "binary": (b"time,q\x00\x01", {}, UnreadableInputError, "log.csv"),
    "UTF-16": ("time,q_hip\n0,1\n".encode("utf-16"), {}, UnreadableInputError, "log.csv"),
    "Latin": (b"time,q_hip\n0,1\n0,\xff\n", {}, UnreadableInputError, "log.csv, line 3"),
    "no header": (b"# made today\n0.0,0.1\n0.1,0.2\n", {}, UnreadableInputError, "log.csv, line 2"),
    "no rows": (b"time,q_hip\n", {}, UnreadableInputError, "log.csv"),
    "nine rows": (table("time,q_hip", "0.1", 9), {}, UnreadableInputError, "log.csv"),
    "a name twice": (table("time,q_hip,q_hip", "1,2"), {}, UnreadableInputError, "log.csv"),
    "no time": (changed(1, HEADER.replace("time", "Time")), {}, UnreadableInputError, "log.csv"),
    "no angles": (changed(1, HEADER.replace("q_", "pos_")), {}, UnreadableInputError, "log.csv"),
    "velocity of one joint": (table("time,q_hip,q_knee,v_hip", "0,0,0"), {}, UnreadableInputError, "log.csv"),
    "misspelt torque": (changed(1, HEADER.replace("tau_knee", "tau_kne")), {}, UnreadableInputError, "log.csv"),
    "no such joint": (GOOD, {"joint_names": ("hip", "ankle")}, UnreadableInputError, "log.csv"),
    "string of joints": (GOOD, {"joint_names": "hip"}, BadArgumentError, ""),
    "no joints": (GOOD, {"joint_names": ()}, BadArgumentError, ""),
    "unit of angles": (GOOD, {"angle_unit": "degrees"}, BadArgumentError, ""),
    "no such header": (GOOD, {"columns": {"q_hip": "q_hipp"}}, UnreadableInputError, "log.csv"),
    "no exoid column": (GOOD, {"columns": {"angle_hip": "q_hip"}}, UnreadableInputError, "log.csv"),
    "torque of no joint": (GOOD, {"columns": {"tau_hpi": "tau_hip"}}, UnreadableInputError, "log.csv"),
    "a header twice": (GOOD, {"columns": {"q_a": "q_hip", "q_b": "q_hip"}}, UnreadableInputError, "log.csv"),
    "unmeasured unknown": (GOOD, {"unmeasured": ("ankle",)}, BadArgumentError, ""),
    "unmeasured string": (GOOD, {"unmeasured": "knee"}, BadArgumentError, ""),
    "names of a headed file": (GOOD, {"names": ("time", "q_a", "", "", "")}, BadArgumentError, "log.csv, line 1"),
    "too many names": (b"0,1\n1,2\n", {"names": ("time", "q_a", "q_b")}, BadArgumentError, "log.csv, line 1"),
    "names in a string": (b"0,1\n1,2\n", {"names": "time,q_a"}, BadArgumentError, ""),
    "topic": (GOOD, {"topic": "/joints"}, BadArgumentError, "log.csv"),
    "no such format": (GOOD, {"format": "odrive:knee"}, UnreadableInputError, ""),
    "another format": (GOOD, {"format": "dephy:knee"}, UnreadableInputError, "log.csv"),
    "mask not there": (GOOD, {"mask": "swing"}, UnreadableInputError, "log.csv"),
    "mask of angles": (GOOD, {"mask": "q_hip"}, BadArgumentError, "log.csv, column q_hip"),
    "nan": (changed(5, "0.06,0.1,0.1,nan,0.1"), {}, UnreadableInputError, CELL),
    "infinite": (changed(5, "0.06,0.1,0.1,-inf,0.1"), {}, UnreadableInputError, CELL),
    "empty cell": (changed(5, "0.06,0.1,0.1,,0.1"), {}, UnreadableInputError, CELL),
    "word": (changed(5, "0.06,0.1,0.1,off,0.1"), {}, UnreadableInputError, CELL),
    "Python's digits": (
        changed(5, "0.06,0.1,0.1,1_0,0.1"),
        {},
        UnreadableInputError,
        "log.csv, line 5, column tau_hip",
    ),
    "Arabic digits": (changed(5, "0.06,0.1,0.1,٣,0.1"), {}, UnreadableInputError, CELL),
    "decimal comma": (
        changed(5, '0.06,0.1,0.1,"0,5",0.1'),
        {},
        UnreadableInputError,
        "log.csv, line 5, column tau_hip",
    ),
    "overflow": (changed(5, "0.06,0.1,0.1,1e300,0.1"), {}, UnreadableInputError, CELL),
    "four cells": (changed(5, "0.06,0.1,0.1,1"), {}, UnreadableInputError, "log.csv, line 5"),
    "six cells": (changed(5, "0.06,0.1,0.1,1,2,3"), {}, UnreadableInputError, "log.csv, line 5"),
    "open quote": (changed(5, '0.03,0.1,0.1,0.1,"1'), {}, UnreadableInputError, "log.csv"),
    "repeated time": (changed(5, "0.04,0.1,0.1,1,1"), {}, UnreadableInputError, "log.csv, line 5"),
    "reversed time": (changed(5, "0.01,0.1,0.1,1,1"), {}, UnreadableInputError, "log.csv, line 5"),
    "degrees": (changed(7, "0.10,0.1,40,1,1"), {}, UnreadableInputError, "log.csv, line 7, column q_knee"),
    "half an IMU": (table("time,q_hip,base_gyro_x", "0.1,0"), {}, UnreadableInputError, "log.csv"),
    "sensor without base": (GOOD, {"base_position": (0.0, 0.0, 0.1)}, UnreadableInputError, "log.csv"),
    "sensor of words": (
        table(IMU, "0,0,0,0,0,0,9.81", above=["# base position: a,b,c"]),
        {},
        UnreadableInputError,
        "log.csv, line of a base position",
    ),
    "another sensor": (
        table(IMU, "0,0,0,0,0,0,9.81", above=["# base position: 0,0,0.1"]),
        {"base_position": (0.0, 0.0, 0.0)},
        UnreadableInputError,
        "log.csv",
    ),
    "payload of words": (
        table("time,q_hip", "0", above=["# payload: three kilograms"]),
        {},
        UnreadableInputError,
        "log.csv, line '# payload:'",
    ),
    "five forces": (table(FOOT.replace(",wrench_foot_my", ""), "0,0,0,500,0,0,1"), {}, UnreadableInputError, "log.csv"),
    "half a contact": (table(FOOT, STANDS[:-1] + "0.5"), {}, UnreadableInputError, "log.csv, column contact_foot"),
    "missing force": (
        table(FOOT, "0.1,0,0,nan,0,0,0,1"),
        {},
        UnreadableInputError,
        "log.csv, line 2, column wrench_foot_fz",
    ),
    "moment in N·mm": (table(FOOT, "0.1,0,0,500,1e5,0,0,1"), {}, UnreadableInputError, "log.csv, wrench on foot"),
    "kilonewtons": (table(FOOT, "0.1,0,0,0.5,0,0,0,1"), {}, UnreadableInputError, "log.csv"),
    "axes of a plate": (table(FOOT, STANDS), {"wrench_frames": {"foot": "plate"}}, UnreadableInputError, ""),
    "axes of no link": (table(FOOT, STANDS), {"wrench_frames": {"hand": "link"}}, UnreadableInputError, "log.csv"),
    "other axes": (
        table(FOOT, STANDS, above=["# wrench: foot:link"]),
        {"wrench_frames": {"foot": "world"}},
        UnreadableInputError,
        "log.csv",
    ),
    "two axes": (
        table(FOOT, STANDS, above=["# wrench: foot:link", "# wrench: foot:world"]),
        {},
        UnreadableInputError,
        "log.csv, line '# wrench:'",
    ),
    "axes without link": (
        table(FOOT, STANDS, above=["# wrench: foot"]),
        {},
        BadArgumentError,
        "log.csv, line '# wrench:'",
    ),
}


@pytest.mark.parametrize(("content", "options", "kind", "where"), LOGS.values(), ids=LOGS)
def test_a_log_that_cannot_be_read_is_refused_with_its_place(tmp_path, monkeypatch, content, options, kind, where):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "log.csv").write_bytes(content)
    with pytest.raises(kind) as error:
        Recording.from_file("log.csv", **options)
    assert error.value.where == where
    assert error.value.remedy
    assert "\n" not in str(error.value)


def test_a_moving_torso_is_refused():
    torso = TorsoMotion(pitch=0.1 * TIME)
    with pytest.raises(NotSupportedError):
        dataclasses.replace(recording(), torso=torso)
