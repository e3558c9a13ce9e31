"""What no recording can be is refused: the kind of the error, and its evidence (row, column, file)."""

import dataclasses
import math
from functools import partial

import numpy as np
import pytest
from outcomes import refused

from exoid import BaseMotion, Recording, TorsoMotion, Wrench
from exoid.errors import BadArgumentError, NotSupportedError, UnreadableInputError
from exoid.leg.payload import Payload
from exoid.signals import Column, MovingAverage, Smoothed, ZeroPhase, contacts_from_wrench, zero_phase
from exoid.signals.differentiation import difference, smooth_motion
from exoid.signals.poses import Approaches, Poses

N = 60
TIME = np.arange(N) / 50.0
STEPS = np.maximum(0.0, np.sin(2.0 * np.pi * 0.9 * TIME))
PHASE = 4.0 * np.column_stack([TIME, TIME + 0.3])
GRAVITY = np.tile([0.0, 0.0, 9.81], (N, 1))
ZERO = np.zeros((N, 3))
NAMES, POSE = ("hip", "knee"), np.array([[0.1, 0.2], [0.3, 0.4], [0.5, 0.6]])


def recording(**changes):
    q, v = 0.5 * np.sin(PHASE), 2.0 * np.cos(PHASE)
    given = {"time": TIME, "q": q, "v": v, "a": -16.0 * q, "tau": 15.0 * v, "joint_names": NAMES}
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


BAD_ARGUMENTS = {
    "three columns": carried(q=np.zeros((N, 3))),
    "fewer rows": carried(tau=np.zeros((N - 1, 2))),
    "no angles": carried(q=None),
    "text": carried(q=[["a", "b"]] * N),
    "same name": carried(joint_names=("hip", "hip")),
    "delimiter in name": carried(joint_names=("hip", "l;knee")),
    "string of names": carried(joint_names="hip"),
    "unknown joint": lambda: recording().select(["hip", "ankle"]),
    "empty slice": lambda: recording().between(50.0, 60.0),
    "passive and driven": carried(passive=("knee",)),
    "passive and held": carried(passive=("knee",), tau=np.full((N, 2), [np.nan, 3.0])),
    "passive with a current": carried(passive=("knee",), tau=None, current=np.full((N, 2), 0.2)),
    "mask of twos": carried(mask=np.full(N, 2)),
    "no segments": lambda: recording().segments([]),
    "segment beyond": lambda: recording().segments([(5.0, 6.0)]),
    "wrenches in a list": lambda: recording(wrenches=[foot()]),
    "link with a comma": lambda: recording(wrenches={"left,foot": foot()}),
    "half a contact": carried(contacts={"foot": np.full(N, 0.5)}),
    "axes of a plate": lambda: foot(axes="plate"),
    "point moves in the link": lambda: foot(point=ZERO),
    "nobody stands": lambda: contacts_from_wrench(load(2.0 * STEPS)),
    "into the ground": lambda: contacts_from_wrench(load(-800.0 * STEPS)),
    "always stands": lambda: contacts_from_wrench(load(400.0 + 300.0 * STEPS)),
    "sensor of two": base(position=np.zeros(2)),
    "sensor in mm": base(position=(50.0, 0.0, 250.0)),
    "sensor nowhere": base(position=(np.nan, 0.0, 0.0)),
    "mounting of two": partial(BaseMotion.from_imu, ZERO, GRAVITY, rotation=np.eye(2)),
    "mounting that scales": partial(BaseMotion.from_imu, ZERO, GRAVITY, rotation=2.0 * np.eye(3)),
    "mirror": partial(BaseMotion.from_imu, ZERO, GRAVITY, rotation=np.diag([1, 1, -1])),
    "norm": posed(put(1, 100, 1.1)),
    "no quaternion": posed(put(1, 100, 0.0)),
    "turn jumps": posed(put(1, (slice(100, None), slice(2, None)), 0.7071)),
    "place jumps": posed(put(0, slice(100, None), 1.0)),
    "uneven poses": posed(put(2, slice(100, None), np.arange(300) / 100.0 + 1.5)),
    "three of four": posed(lambda p, h, t: (p, h[:, :3], t)),
    "no cut-off": posed(cutoff=0.0),
    "scale zero": lambda: Column("cur", scale=0.0),
    "zero infinite": lambda: Column("cur", zero=np.inf),
    "scale as text": lambda: Column("cur", scale="2"),
    "payload without place": lambda: Payload.from_text("knee:3"),
    "payload of words": lambda: Payload.from_text("knee:heavy@0,0,0"),
    "payload in grams": lambda: Payload("hip", 3000.0),
    "payload in mm": lambda: Payload("hip", 1.0, (0.0, 0.0, -300.0)),
    "half the rate": lambda: zero_phase(ZERO, 50.0, 25.0),
    "no cut-off of a filter": lambda: zero_phase(ZERO, 50.0, np.nan),
    "cut-off of text": lambda: ZeroPhase("8"),
    "smoothing without cut-off": lambda: Smoothed(0.0),
    "negative cut-off": lambda: ZeroPhase(kinematics_cutoff=-1.0),
    "weight of nothing": lambda: MovingAverage(0.0),
    "fewer torques than poses": lambda: Poses(POSE, POSE[:2], NAMES),
    "torques of one joint": lambda: Poses(POSE, POSE[:, :1], NAMES),
    "one pose": lambda: Poses(POSE[0], POSE, NAMES),
    "ragged torques": lambda: Poses(POSE, [[1.0, 2.0], [3.0], [4.0, 5.0]], NAMES),
    "torques of text": lambda: Poses(POSE, [["a", "b"]] * 3, NAMES),
    "approaches of other poses": lambda: Approaches(Poses(POSE, POSE, NAMES), Poses(POSE[:2], POSE[:2], NAMES)),
    "approaches of other joints": lambda: Approaches(Poses(POSE, POSE, NAMES), Poses(POSE, POSE, NAMES[::-1])),
    "no such joint of poses": lambda: Poses(POSE, POSE, NAMES).select(("ankle",)),
    "rate too low": lambda: ZeroPhase().kinematics(recording(time=5.0 * TIME, v=None)),
}

UNREADABLE = {
    **{
        f"{value} in {name}": (cell(name, 17, value), "time" if name == "time" else f"{name}_knee")
        for name in ("time", "q", "v", "a", "tau")
        for value in (math.nan, math.inf, -math.inf)
    },
    "masked": (carried(tau=np.ma.masked_equal(np.eye(N, 2), 1.0)), "tau_hip"),
    "overflow": (cell("tau", 3, 1e300), "tau_knee"),
    "degrees": (cell("q", 12, -45.0), "q_knee"),
    "repeated time": (cell("time", 31, 0.6), ""),
    "reversed time": (cell("time", 31, 0.1), ""),
    "nanoseconds": (carried(time=1e13 * TIME), "time"),
    "short slice": (lambda: recording().slice(0, 9), ""),
    "gap in current": (carried(current=np.where(np.eye(N, 2), np.nan, 1.0)), "i_hip"),
    "dict as base": (carried(base={}), ""),
    "missing moment": (lambda: foot(moment=np.full((N, 3), np.nan)), "mx"),
    "point in mm": (lambda: foot(point=(50.0, 0.0, -80.0)), ""),
    "force in mN": (lambda: foot(force=np.full((N, 3), 4e5)), ""),
    "moment in N·mm": (lambda: foot(moment=np.full((N, 3), 3e4)), ""),
    "line of force far away": (lambda: foot(force=np.tile([0.3, 0, 0], (N, 1)), moment=np.tile([0, 9, 0], (N, 1))), ""),
    "missing gyro": (base(gyro=np.full((N, 3), np.nan)), "base_gyro_x"),
    "few poses": (posed(lambda p, h, t: (p[:15], h[:15], t[:15])), ""),
    "unit of current for torque": (lambda: Column("c", unit="mA").read("tau_hip", TIME), ""),
    "unit of time for angle": (lambda: Column("c", unit="ms").read("q_hip", TIME), ""),
    "short for its filter": (lambda: zero_phase(ZERO[:9], 50.0, 1.0), ""),
    "short for its continuation": (lambda: smooth_motion(ZERO[:39], 200.0, 10.0), ""),
    "short for a difference": (lambda: difference(ZERO[:2], 50.0, 1), ""),
    "poses in degrees": (lambda: Poses(np.rad2deg(POSE), POSE, NAMES), "q_knee"),
    "torque of a pose missing": (lambda: Poses(POSE, np.where(POSE > 0.5, np.nan, POSE), NAMES), "tau_knee"),
    "only edges": (lambda: MovingAverage(0.01).kinematics(recording()), ""),
}
"""What is refused, and the column that the error names."""


@pytest.mark.parametrize("call", BAD_ARGUMENTS.values(), ids=BAD_ARGUMENTS)
def test_arguments_that_no_recording_can_have_are_refused(call):
    assert refused(BadArgumentError, call).remedy


@pytest.mark.parametrize(("call", "column"), UNREADABLE.values(), ids=UNREADABLE)
def test_values_that_no_recording_can_have_are_refused_with_their_column(call, column):
    error = refused(UnreadableInputError, call)
    assert (error.column, bool(error.remedy)) == (column, True)


HEADER = "time,q_hip,q_knee,tau_hip,tau_knee"
ROWS = [f"{0.02 * k:.2f},{0.1 * math.sin(k / 9):.4f},{-0.01 * k:.2f},{k},{-k}.5" for k in range(12)]
IMU = "time,q_hip,base_gyro_x,base_gyro_y,base_gyro_z,base_acc_x,base_acc_y,base_acc_z"
FOOT = ",".join(
    ["time,q_hip", *(f"wrench_foot_{part}" for part in ("fx", "fy", "fz", "mx", "my", "mz")), "contact_foot"]
)


class Log:
    def __init__(self, content, place="", kind=UnreadableInputError, name="log.csv", **options):
        self.content, self.place, self.kind, self.name, self.options = content, place, kind, name, options


def changed(line, text):
    """A good log with one line (counted from 1) replaced."""
    lines = [HEADER, *ROWS]
    lines[line - 1] = text
    return "\n".join(lines).encode()


def table(header, row, count=12, above=()):
    return "\n".join([*above, header, *(f"{0.02 * k:.2f},{row}" for k in range(count))]).encode()


GOOD = changed(1, HEADER)
STANDS = "0.1,0,0,500,0,0,0,1"

LOGS = {
    "empty": Log(b""),
    "comments": Log(b"# nothing here\n"),
    "binary": Log(b"time,q\x00\x01"),
    "Latin": Log(b"time,q_hip\n0,1\n0,\xff\n", "line 3"),
    "no header": Log(b"# made today\n0.0,0.1\n0.1,0.2\n", "line 2"),
    "no rows": Log(b"time,q_hip\n"),
    "quotes without end": Log(b'time\tq_a\n1\t"\n' + 2**21 * b"\n" + b"\0", "line 2"),  # before the rest is read
    "a line without end": Log(table("time,q_hip,note", "0," + "1" * 2**21), "line 2"),
    "nine rows": Log(table("time,q_hip", "0.1", 9)),
    "a name twice": Log(table("time,q_hip,q_hip", "1,2")),
    "no time": Log(changed(1, HEADER.replace("time", "Time"))),
    "no angles": Log(changed(1, HEADER.replace("q_", "pos_"))),
    "velocity of one joint": Log(table("time,q_hip,q_knee,v_hip", "0,0,0")),
    "misspelt torque": Log(changed(1, HEADER.replace("tau_knee", "tau_kne"))),
    "no such joint": Log(GOOD, joint_names=("hip", "ankle")),
    "string of joints": Log(GOOD, joint_names="hip", kind=BadArgumentError),
    "no such header": Log(GOOD, columns={"q_hip": "q_hipp"}),
    "torque of no joint": Log(GOOD, columns={"tau_hpi": "tau_hip"}),
    "a header twice": Log(GOOD, columns={"q_a": "q_hip", "q_b": "q_hip"}),
    "unmeasured unknown": Log(GOOD, unmeasured=("ankle",), kind=BadArgumentError),
    "topic": Log(GOOD, topic="/joints", kind=BadArgumentError),
    "mask not there": Log(GOOD, mask="swing"),
    "mask of angles": Log(GOOD, "column q_hip", mask="q_hip", kind=BadArgumentError),
    "nan": Log(changed(5, "0.06,0.1,0.1,nan,0.1"), "line 5, column tau_hip"),
    "empty cell": Log(changed(5, "0.06,0.1,0.1,,0.1"), "line 5, column tau_hip"),
    "word": Log(changed(5, "0.06,0.1,0.1,off,0.1"), "line 5, column tau_hip"),
    "decimal comma": Log(changed(5, '0.06,0.1,0.1,"0,5",0.1'), "line 5, column tau_hip"),
    "four cells": Log(changed(5, "0.06,0.1,0.1,1"), "line 5"),
    "repeated time": Log(changed(5, "0.04,0.1,0.1,1,1"), "line 5"),
    "reversed time": Log(changed(5, "0.01,0.1,0.1,1,1"), "line 5"),
    "degrees": Log(changed(7, "0.10,0.1,40,1,1"), "line 7, column q_knee"),
    "half an IMU": Log(table("time,q_hip,base_gyro_x", "0.1,0")),
    "sensor without base": Log(GOOD, base_position=(0.0, 0.0, 0.1)),
    "sensor of words": Log(table(IMU, "0,0,0,0,0,0,9.81", above=["# base position: a,b,c"]), "line of a base position"),
    "payload of words": Log(table("time,q_hip", "0", above=["# payload: three kilograms"]), "line '# payload:'"),
    "five forces": Log(table(FOOT.replace(",wrench_foot_my", ""), "0,0,0,500,0,0,1")),
    "half a contact": Log(table(FOOT, STANDS[:-1] + "0.5"), "column contact_foot", BadArgumentError),
    "kilonewtons": Log(table(FOOT, "0.1,0,0,0.5,0,0,0,1")),
    "axes of a plate": Log(
        table(FOOT, STANDS), "wrench_frames", wrench_frames={"foot": "plate"}, kind=BadArgumentError
    ),
    "axes of no link": Log(table(FOOT, STANDS), wrench_frames={"hand": "link"}),
    "axes without link": Log(table(FOOT, STANDS, above=["# wrench: foot"]), "line '# wrench:'", kind=BadArgumentError),
}
"""A log, the place in it that the error names, and the options it is read with."""


def motion(*entries, rows=12, end="endheader", names="time\tknee", change=("old", "new")):
    """A motion file of OpenSim, with a change of its text."""
    lines = ["Coordinates", *entries, end, names, *(f"{k / 100}\t{k / 10}" for k in range(rows))]
    return "\n".join([*lines, ""]).replace(*change).encode()


SIZES = ("nRows=12", "nColumns=2", "inDegrees=no")
MOTIONS = {
    "a row less": (motion(*SIZES, rows=11), ""),
    "perhaps degrees": (motion("inDegrees=perhaps"), ""),
    "degrees and radians": (motion("inDegrees=no", "Angles are in degrees."), ""),
    "no end of the header": (motion(*SIZES, end="nRows=12"), ""),
    "a name twice": (motion(*SIZES, names="knee\tknee"), ""),
    "no time": (motion(*SIZES, names="t\tknee"), ""),
    "time missing": (motion(*SIZES, change=("0.05\t", "nan\t")), "line 12, column time"),
    "angle missing": (motion(*SIZES, change=("\t0.5", "\tnan")), "line 12, column knee (q_knee)"),
    "one cell": (motion(*SIZES, change=("\t0.5", "")), "line 12"),
    "nine rows": (motion(rows=9), ""),
}
LOGS |= {
    f"motion, {what}": Log(content, place, name="log.mot", columns={"q_knee": "knee"})
    for what, (content, place) in MOTIONS.items()
}


@pytest.mark.parametrize("log", LOGS.values(), ids=LOGS)
def test_a_log_that_cannot_be_read_is_refused_with_its_place(tmp_path, monkeypatch, log):
    monkeypatch.chdir(tmp_path)
    (tmp_path / log.name).write_bytes(log.content)
    error = refused(log.kind, lambda: Recording.from_file(log.name, **log.options))
    assert error.remedy
    assert error.file == log.name
    assert error.where == ", ".join(filter(None, (log.name, log.place)))


def test_a_moving_torso_is_refused():
    torso = TorsoMotion(pitch=0.1 * TIME)
    with pytest.raises(NotSupportedError):
        dataclasses.replace(recording(), torso=torso)
