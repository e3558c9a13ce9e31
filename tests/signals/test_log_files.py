"""Logs that are not CSV: what other libraries wrote comes back bit by bit, and whatever is wrong is named."""

import dataclasses
import datetime
import hashlib
import pickle
import re
import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np
import outcomes
import polars
import pytest
import scipy
from hypothesis import given, settings
from hypothesis import strategies as st
from log_writers import BAGS, WRITERS, arrays, messages, named_columns, write_bag

from exoid import ExoidError
from exoid.signals import Recording


def swing(samples=40, joints=("hip", "knee"), rate=100.0, seed=0, **changes):
    """A recording with every quantity; stamps are whole nanoseconds, so that bags can hold them."""
    rng = np.random.default_rng(seed)
    time = np.round(np.arange(samples) / rate * 1e9) / 1e9
    q, a, tau = rng.uniform(-1.0, 1.0, (3, samples, len(joints)))
    return Recording(**{"time": time, "q": q, "v": 0.1 * a, "a": a, "tau": tau, "joint_names": joints, **changes})


def refused(path, match, **options):
    error = outcomes.refused(ExoidError, lambda: Recording.from_file(path, **options))
    assert error.remedy
    assert re.search(match, str(error)), error
    return str(error)


@pytest.fixture(params=WRITERS)
def kind(request):
    return request.param


@pytest.fixture(params=["log.npz", "struct.mat", "log.parquet", "mcap_bag"])
def one_kind(request):
    """A kind of each reader."""
    return request.param


# What is read


def test_every_kind_reads_back_bit_by_bit(kind, tmp_path):
    recording = swing()
    WRITERS[kind](tmp_path / kind, recording)
    again = Recording.from_file(tmp_path / kind)
    assert again.joint_names == recording.joint_names
    expected = dataclasses.replace(recording, a=None) if kind in BAGS else recording
    assert arrays(again).keys() == arrays(expected).keys()
    np.testing.assert_array_equal(again.time, recording.time)
    for name, values in arrays(expected).items():
        np.testing.assert_array_equal(getattr(again, name), values, err_msg=name)


def test_every_kind_lets_joints_be_chosen_and_renamed(one_kind, tmp_path):
    recording = swing(joints=("hip", "knee", "ankle"), v=None, a=None)
    WRITERS[one_kind](tmp_path / one_kind, recording)
    columns = {"q_thigh": "q_hip", "tau_thigh": "tau_hip"}
    again = Recording.from_file(tmp_path / one_kind, joint_names=("ankle", "thigh"), columns=columns)
    assert again.joint_names == ("ankle", "thigh")
    np.testing.assert_array_equal(again.q, recording.q[:, [2, 0]])
    np.testing.assert_array_equal(again.tau, recording.tau[:, [2, 0]])
    assert again.v is None


def test_every_kind_may_hold_degrees(one_kind, tmp_path):
    recording = swing()
    q, v, a = (np.rad2deg(x) for x in (recording.q, recording.v, recording.a))
    degrees = swing(q=q, v=v, a=a, largest_angle=np.inf)
    WRITERS[one_kind](tmp_path / one_kind, degrees)
    again = Recording.from_file(tmp_path / one_kind, angle_unit="deg")
    for name in ("q", "v") if again.a is None else ("q", "v", "a"):  # bags have no accelerations
        np.testing.assert_allclose(getattr(again, name), getattr(recording, name), rtol=1e-14)
    np.testing.assert_array_equal(again.tau, recording.tau)
    assert "looks like degrees" in refused(tmp_path / one_kind, "rad", joint_names=("knee",))


@pytest.mark.parametrize("kind", [kind for kind in WRITERS if kind.startswith("log")])
def test_the_beginning_of_a_file_says_its_kind_not_its_name(kind, tmp_path):
    WRITERS[kind](tmp_path / kind, swing())
    shutil.move(tmp_path / kind, tmp_path / "log.csv")
    np.testing.assert_array_equal(Recording.from_file(tmp_path / "log.csv").q, swing().q)


def test_a_file_is_evidence(kind, tmp_path):
    path = tmp_path / kind
    WRITERS[kind](path, swing())
    source = Recording.from_file(path).source
    assert source.name == kind
    if path.is_dir():
        files = sorted(path.iterdir())
        listed = "".join(f"{hashlib.sha256(file.read_bytes()).hexdigest()}  {file.name}\n" for file in files)
        assert source.sha256 == hashlib.sha256(listed.encode()).hexdigest()
    else:
        assert source.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()


def test_whatever_the_kind_a_value_that_is_missing_is_named_by_its_place(one_kind, tmp_path):
    recording = swing()
    tau = recording.tau.copy()
    tau[17, 1] = np.nan
    broken = Recording(time=recording.time, q=recording.q, tau=recording.tau, joint_names=recording.joint_names)
    object.__setattr__(broken, "tau", tau)  # a recording itself would refuse it
    WRITERS[one_kind](tmp_path / one_kind, broken)
    place = {"struct.mat": "row 18", "mcap_bag": "message 17"}.get(one_kind, "row 17")
    message = refused(tmp_path / one_kind, "nan is not a finite number")
    assert f"{one_kind}, {place}, column tau_knee" in message


names = st.text("abcdefghijklmnopqrstuvwxyz_ 0123456789", min_size=1, max_size=12).filter(lambda x: x == x.strip())
csv_names = st.text(min_size=1, max_size=8).filter(lambda x: x.isprintable() and x == x.strip() and not {*x} & {*',;"'})


@given(st.data())
@settings(max_examples=60)
def test_any_recording_reads_back_from_any_kind(data):
    write = {"log.csv": lambda path, log: log.to_csv(path), **WRITERS}
    kind = data.draw(st.sampled_from([kind for kind in write if kind not in BAGS]))
    of_kind = csv_names if kind == "log.csv" else names
    joints = tuple(data.draw(st.lists(of_kind, min_size=1, max_size=4, unique=True)))
    samples = data.draw(st.integers(10, 30))
    has = data.draw(st.sets(st.sampled_from(["a", "tau"])))
    rng = np.random.default_rng(data.draw(st.integers(0, 2**32)))
    scale = 10.0 ** data.draw(st.integers(-12, 8))
    values = {name: scale * rng.standard_normal((samples, len(joints))) for name in has}
    q = rng.uniform(-6.0, 6.0, (samples, len(joints)))
    recording = Recording(time=np.cumsum(rng.uniform(0.001, 0.1, samples)), q=q, joint_names=joints, **values)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / kind
        write[kind](path, recording)
        again = Recording.from_file(path, resample=False)
    assert again.joint_names == joints
    assert arrays(again).keys() == arrays(recording).keys()
    for name in ("time", *arrays(recording)):
        assert getattr(again, name).tobytes() == getattr(recording, name).tobytes()


# Parquet


def test_parquet_may_hold_dates_integers_decimals_and_columns_that_do_not_matter(tmp_path):
    start = datetime.datetime(2024, 5, 1, 12, tzinfo=datetime.timezone.utc)
    frame = polars.DataFrame(
        {
            "stamp": [start + datetime.timedelta(milliseconds=10 * k) for k in range(12)],
            "q_hip": list(range(-5, 7)),
            "tau_hip": [str(k / 4) for k in range(12)],
            "mode": ["walk"] * 12,
            "pair": [{"left": 1.0, "right": 2.0}] * 12,
        }
    ).with_columns(polars.col("tau_hip").cast(polars.Decimal(10, 2)))
    frame.write_parquet(tmp_path / "log.parquet")
    recording = Recording.from_file(tmp_path / "log.parquet", columns={"time": "stamp"})
    np.testing.assert_allclose(recording.time, np.arange(12) / 100.0, atol=1e-15)
    np.testing.assert_array_equal(recording.q[:, 0], np.arange(-5, 7))
    np.testing.assert_array_equal(recording.tau[:, 0], np.arange(12) / 4)
    for name in ("mode", "pair"):
        message = refused(tmp_path / "log.parquet", "not real numbers", columns={"time": "stamp", "q_hip": name})
        assert f"column {name}" in message


# NumPy and MATLAB


def test_the_caller_names_the_joints_of_matrices_that_have_no_names(tmp_path):
    recording = swing()
    path = tmp_path / "log.npz"
    np.savez(path, time=recording.time, q=recording.q, tau=recording.tau, rate=100.0, gain=np.ones((3, 3)))
    again = Recording.from_file(path, joint_names=("hip", "knee"))
    np.testing.assert_array_equal(again.tau, recording.tau)
    message = refused(path, "no column 'q_<joint>'")
    assert "the file has: time, q[0], q[1], tau[0], tau[1]" in message
    refused(path, "no column 'q_hip'", joint_names=("hip",))
    mapped = Recording.from_file(path, columns={"q_knee": "q[1]", "tau_knee": "tau[1]"})
    np.testing.assert_array_equal(mapped.q[:, 0], recording.q[:, 1])


def test_an_array_of_another_length_than_time_is_no_column(tmp_path):
    recording = swing()
    np.savez(tmp_path / "log.npz", time=recording.time, q_hip=recording.q[:-1, 0])
    refused(tmp_path / "log.npz", "no joint angle")
    np.savez(tmp_path / "log.npz", q_hip=recording.q[:, 0])
    assert "q_hip (40,)" in refused(tmp_path / "log.npz", "no array 'time'")
    np.savez(tmp_path / "log.npz", time=recording.q, q_hip=recording.q[:, 0])
    refused(tmp_path / "log.npz", r"time has shape \(40, 2\)")


def test_a_pickle_is_never_opened(tmp_path):
    trap = tmp_path / "sprung"

    class Trap:
        def __reduce__(self):
            return Path.touch, (trap,)

    np.savez(tmp_path / "log.npz", time=swing().time, q_hip=np.array([Trap()] * 40, dtype=object))
    refused(tmp_path / "log.npz", "[Oo]bject arrays cannot be loaded")
    (tmp_path / "raw.npz").write_bytes(pickle.dumps(Trap()))
    refused(tmp_path / "raw.npz", "cannot be read as a NumPy archive")
    assert not trap.exists()


def test_matlab_version_4_is_read(tmp_path):
    recording = swing()
    columns = {name: values[:, None] for name, values in named_columns(recording).items()}
    scipy.io.savemat(tmp_path / "log.mat", columns, format="4")
    np.testing.assert_array_equal(Recording.from_file(tmp_path / "log.mat").tau, recording.tau)


def test_fields_of_one_struct_among_other_variables_are_mapped_by_their_path(tmp_path):
    recording = swing()
    inner = {"t": recording.time, "pos": recording.q, "notes": {"who": "me"}}
    scipy.io.savemat(tmp_path / "log.mat", {"run": inner, "rate": 100.0})
    columns = {"time": "run.t", "q_hip": "run.pos[0]", "q_knee": "run.pos[1]"}
    again = Recording.from_file(tmp_path / "log.mat", columns=columns)
    np.testing.assert_array_equal(again.q, recording.q)


# Bags


def test_joints_in_another_order_in_each_message_are_put_in_one(tmp_path):
    recording, rng = swing(joints=("hip", "knee", "ankle"), a=None), np.random.default_rng(3)
    shuffled = []
    for stamp, names, *fields in messages(recording):
        order = rng.permutation(3)
        shuffled.append((stamp, [names[k] for k in order], *(field[order] for field in fields)))
    write_bag(tmp_path / "bag", {"/joint_states": shuffled})
    again = Recording.from_file(tmp_path / "bag").select(recording.joint_names)
    for name in ("q", "v", "tau"):
        np.testing.assert_array_equal(getattr(again, name), getattr(recording, name))


def test_empty_and_unmeasured_fields_are_absent(tmp_path):
    recording = swing(v=None, a=None)
    write_bag(tmp_path / "empty", {"/joint_states": messages(recording)})
    assert Recording.from_file(tmp_path / "empty").v is None
    unmeasured = [(*start, np.full(2, np.nan), effort) for *start, _, effort in messages(recording)]
    write_bag(tmp_path / "nan", {"/joint_states": unmeasured})
    assert Recording.from_file(tmp_path / "nan").v is None
    now_and_then = messages(recording)
    now_and_then[7] = (*now_and_then[7][:-1], np.empty(0))
    write_bag(tmp_path / "some", {"/joint_states": now_and_then})
    assert "message 7" in refused(tmp_path / "some", "effort is empty, but not in all messages")
    now_and_then[7] = (*now_and_then[7][:-1], np.ones(1))
    write_bag(tmp_path / "one", {"/joint_states": now_and_then})
    assert "message 7" in refused(tmp_path / "one", "1 values of effort for 2 joints")


def test_the_topic_is_chosen_where_several_fit_and_named_where_none_does(tmp_path):
    left, right = swing(seed=1, a=None), swing(seed=2, a=None)
    write_bag(tmp_path / "two", {"/left": messages(left), "/right": messages(right), "/chatter": "hello"})
    refused(tmp_path / "two", "2 topics of joint states: /left, /right")
    assert "/chatter (std_msgs/msg/String)" in refused(tmp_path / "two", "no topic '/up'", topic="/up")
    refused(tmp_path / "two", "no topic '/chatter'", topic="/chatter")
    np.testing.assert_array_equal(Recording.from_file(tmp_path / "two", topic="/right").q, right.q)
    write_bag(tmp_path / "none", {"/chatter": "hello"})
    refused(tmp_path / "none", r"no joint states, but: /chatter \(std_msgs/msg/String\)")


def test_stamps_are_those_of_the_header_unless_asked_otherwise(tmp_path):
    recording = swing(a=None)
    unstamped = [(0, *fields) for _, *fields in messages(recording)]
    write_bag(tmp_path / "bag", {"/joint_states": messages(recording)}, late=3_000_000)
    for stamps in ("header", "received"):
        np.testing.assert_array_equal(Recording.from_file(tmp_path / "bag", stamps=stamps).time, recording.time)
    write_bag(tmp_path / "unstamped", {"/joint_states": unstamped})
    assert "--received" in refused(tmp_path / "unstamped", "headers have no time stamps")
    refused(tmp_path / "unstamped", "time is repeated", stamps="received")
    refused(tmp_path / "bag", "stamps is 'arrival'", stamps="arrival")


def test_two_publishers_of_one_topic_are_told_apart_by_their_joints(tmp_path):
    leg, wheels = swing(a=None), swing(joints=("left_wheel", "right_wheel"), seed=4, a=None)
    mixed = sorted([*messages(leg), *((stamp + 1, *rest) for stamp, *rest in messages(wheels))], key=lambda m: m[0])
    write_bag(tmp_path / "bag", {"/joint_states": mixed})
    refused(tmp_path / "bag", "messages hold different joints: hip, knee; left_wheel, right_wheel")
    again = Recording.from_file(tmp_path / "bag", joint_names=("knee", "hip"))
    np.testing.assert_array_equal(again.q, leg.q[:, ::-1])
    refused(tmp_path / "bag", "no left_wheel beside hip, knee", joint_names=("hip", "left_wheel"))


# What cannot be read


@pytest.mark.parametrize("package", ["polars", "rosbags"])
def test_a_missing_package_is_named_with_the_extra_that_brings_it(package, tmp_path, monkeypatch):
    kind = {"polars": "log.parquet", "rosbags": "mcap_bag"}[package]
    WRITERS[kind](tmp_path / kind, swing())
    monkeypatch.setitem(sys.modules, package, None)
    message = refused(tmp_path / kind, f"needs {package}")
    assert re.search(rf"pip install .*'{package}>=", message)


def test_what_is_no_log_is_named(tmp_path):
    refused(tmp_path, "is a directory, not a file")
    refused(tmp_path / "missing.parquet", "no such file")
    (tmp_path / "empty.npz").touch()
    refused(tmp_path / "empty.npz", "the file is empty")
    (tmp_path / "text.mcap").write_text("time,q_hip\n")
    refused(tmp_path / "text.mcap", "cannot be read as a bag")
    (tmp_path / "photo.csv").write_bytes(b"\xff\xd8\xff\xe0\0\x10JFIF")
    refused(tmp_path / "photo.csv", "binary, not text")
    (tmp_path / "bag").mkdir()
    (tmp_path / "bag" / "metadata.yaml").write_text("rosbag2_bagfile_information: {version: 99}")
    refused(tmp_path / "bag", "version 99 not supported")
    refused("a\0b", "cannot be read")


def test_a_file_that_ends_too_early_is_refused_wherever_it_ends(kind, tmp_path):
    path = tmp_path / kind
    WRITERS[kind](path, swing())
    file = path if path.is_file() else next(each for each in path.iterdir() if each.suffix in (".mcap", ".db3"))
    whole = file.read_bytes()
    for share in (0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.97):
        file.write_bytes(whole[: int(share * len(whole))])
        result = outcomes.outcome(Recording.from_file, path, resample=False)
        if isinstance(result, Recording):  # a log that was cut off between two of its rows
            np.testing.assert_array_equal(result.q, swing().q[: len(result)])
