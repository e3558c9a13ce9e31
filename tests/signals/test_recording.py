"""A recording is checked when it is made and does not change afterwards."""

from __future__ import annotations

import dataclasses
import math
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from exoid import ExoidError
from exoid.signals import Approaches, FiniteDifference, Poses, Recording, Source

JOINTS = ("hip", "left_knee")
TIME = np.arange(60) / 50.0


def arrays(**changes):
    """A small valid motion of two joints, with changes."""
    phase = np.column_stack([TIME, TIME + 0.3]) * 4.0
    made = {
        "q": 0.5 * np.sin(phase),
        "v": 2.0 * np.cos(phase),
        "a": -8.0 * np.sin(phase),
        "tau": 30.0 * np.cos(phase),
    }
    return {"time": TIME, **made, "joint_names": JOINTS, **changes}


def refused(match, **changes):
    with pytest.raises(ExoidError, match=match):
        Recording(**arrays(**changes))


def with_cell(name, row, column, value):
    values = arrays()[name].copy()
    values[row, column] = value
    return {name: values}


def test_a_recording_tells_its_size_rate_and_duration():
    recording = Recording(**arrays())
    assert (len(recording), recording.n_joints) == (60, 2)
    assert recording.sample_rate == pytest.approx(50.0, rel=1e-12)
    assert recording.duration == pytest.approx(59 / 50)
    assert recording.is_uniform
    assert repr(recording) == "Recording(60 samples at 50 Hz, 1.18 s; joints: hip, left_knee; q, v, a, tau)"


def test_only_time_angles_and_names_are_required():
    recording = Recording(TIME, arrays()["q"], joint_names=JOINTS)
    assert recording.v is None
    assert recording.a is None
    assert recording.tau is None
    assert recording.source is None


def test_arrays_are_copies_that_cannot_be_written():
    given = arrays(q=np.asfortranarray(arrays()["q"]))
    recording = Recording(**given)
    given["q"][0, 0] = 1.0
    assert recording.q[0, 0] != 1.0
    for name in ("time", "q", "v", "a", "tau"):
        values = getattr(recording, name)
        assert values.dtype == np.float64
        assert values.flags.c_contiguous
        with pytest.raises(ValueError, match="read-only"):
            values[0] = 0.0


def test_fields_cannot_be_rebound():
    with pytest.raises(dataclasses.FrozenInstanceError):
        Recording(**arrays()).q = np.zeros((60, 2))


def test_lists_and_integers_become_float64_and_a_list_of_names_a_tuple():
    recording = Recording(time=list(range(12)), q=[[0, 1]] * 12, joint_names=["hip", "knee"])
    assert recording.q.dtype == recording.time.dtype == np.float64
    assert recording.joint_names == ("hip", "knee")


@pytest.mark.parametrize("name", ["time", "q", "v", "a", "tau"])
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_value_that_is_not_finite_is_refused_with_row_and_column(name, value):
    if name == "time":
        time = TIME.copy()
        time[17] = value
        refused(rf"^row 17, column time: {value} is not a finite number", time=time)
    else:
        changes = with_cell(name, 17, 1, value)
        refused(rf"^row 17, column {name}_left_knee: {value} is not .*\(1 such .*drop those rows", **changes)


def test_masked_entries_are_refused_as_missing():
    mask = np.zeros((60, 2), dtype=bool)
    mask[4, 0] = True
    refused("row 4, column tau_hip: nan", tau=np.ma.array(arrays()["tau"], mask=mask))


@pytest.mark.parametrize(
    ("name", "values", "match"),
    [
        ("q", np.zeros((60, 3)), r"q has shape \(60, 3\), expected \(60, 2\)"),
        ("tau", np.zeros((59, 2)), r"tau has shape \(59, 2\), expected \(60, 2\).*one row per time stamp"),
        ("v", np.zeros((2, 60)), r"v has shape \(2, 60\), .*pass v\.T"),
        ("a", np.zeros(60), r"a has shape \(60,\), .*a\[:, np.newaxis\]"),
        ("time", np.zeros((60, 1)), r"time has shape \(60, 1\), expected \(60,\)"),
        ("time", 3.0, r"time has shape \(\), expected \(1,\)"),
        ("q", None, r"q has shape \(\)"),
        ("q", [["a", "b"]] * 60, "q is not an array of real numbers: its elements are <U1"),
        ("q", np.ones((60, 2), dtype=complex), "q is not an array of real numbers.*complex"),
        ("tau", [[1.0, 2.0], [3.0]], "tau is not an array of real numbers"),
        ("time", TIME.astype("datetime64[s]"), "time is not an array of real numbers.*datetime"),
    ],
)
def test_an_array_of_wrong_shape_or_kind_is_refused_by_name(name, values, match):
    refused(match, **{name: values})


@pytest.mark.parametrize(
    ("names", "match"),
    [
        (("hip", "hip"), "'hip' occurs 2 times"),
        (("hip", ""), "'' is not a printable, non-empty string"),
        (("hip", " knee"), "' knee' is not"),
        (("hip", "kn\nee"), "is not a printable"),
        (("hip", 3), "joint name 3 is not"),
        (("hip", "l;knee"), "'l;knee' contains one of"),
        ("hip", r"the string 'hip'.*joint_names=\('hip',\)"),
        ((), "joint_names is empty"),
        (("hip",), r"q has shape \(60, 2\), expected \(60, 1\)"),
    ],
)
def test_joint_names_that_do_not_name_the_columns_are_refused(names, match):
    refused(match, joint_names=names)


def test_repeated_and_reversed_time_are_told_apart_and_located():
    for stamp, kind in (
        (TIME[30], "is repeated: 0.6 s after 0.6 s"),
        (0.1, "runs backwards: 0.1 s after 0.6 s"),
    ):
        time = TIME.copy()
        time[31] = stamp
        refused(rf"^row 31: time {kind}.*split a log", time=time)


@pytest.mark.parametrize(("factor", "match"), [(1e13, "milli- or nanoseconds"), (1e-9, "too short for a log")])
def test_time_that_cannot_be_in_seconds_is_refused(factor, match):
    refused(match, time=TIME * factor)


def test_nine_samples_are_too_few_and_ten_are_enough():
    few = {name: arrays()[name][:9] for name in ("time", "q", "v", "a", "tau")}
    refused("too few samples: 9, at least 10", **few)
    assert len(Recording(**arrays()).slice(0, 10)) == 10


def test_degrees_passed_as_radians_are_refused_with_both_remedies():
    q = arrays()["q"].copy()
    q[12, 1] = -45.0
    refused(
        r'^row 12, column q_left_knee: an angle of -45 rad .*angle_unit="deg".*deg2rad.*largest_angle',
        q=q,
        v=None,
    )


def test_a_joint_that_really_turns_far_is_allowed_and_stays_allowed():
    q = np.column_stack([20.0 * TIME, TIME])
    recording = Recording(**arrays(q=q, v=None), largest_angle=math.inf)
    assert recording.slice(20).select(["hip"]).q.max() > 20.0
    assert dataclasses.replace(recording, a=None).q.max() > 20.0


@pytest.mark.parametrize("limit", [0.0, -1.0, math.nan])
def test_a_limit_on_angles_that_is_not_positive_is_refused(limit):
    refused("largest_angle is", largest_angle=limit)


def test_values_that_no_leg_can_have_are_refused_before_they_overflow():
    refused(r"^row 3, column tau_hip: 1e\+300 is not plausible", **with_cell("tau", 3, 0, 1e300))


@pytest.mark.parametrize("noise", [0.0, 1e-3])
def test_velocity_in_degrees_beside_angles_in_radians_is_refused_noise_or_not(noise):
    rng = np.random.default_rng(0)
    q = arrays()["q"] + noise * rng.normal(size=(60, 2))
    v = arrays()["v"] + noise * rng.normal(size=(60, 2))
    refused(
        r"v of joint hip is 5\d\.\d times the rate of its q: v looks like degrees.*deg2rad\(v\)",
        q=q,
        v=np.rad2deg(v),
    )
    refused(r"v of joint hip is 0\.01\d+ times .*: q looks like degrees", q=10.0 * q, v=np.deg2rad(10.0 * v))


def test_one_joint_with_velocity_in_degrees_is_enough_to_refuse():
    v = arrays()["v"] * [1.0, 180.0 / np.pi]
    refused("v of joint left_knee", v=v)


@pytest.mark.parametrize("factor", [0.002, 0.1, 0.5, 10.0, 40.0, 80.0, 500.0])
def test_a_velocity_that_is_wrong_by_another_factor_is_not_called_degrees(factor):
    assert Recording(**arrays(v=factor * arrays()["v"])).v is not None


def test_a_velocity_of_another_shape_than_the_motion_is_not_called_degrees():
    assert Recording(**arrays(v=np.rad2deg(4.0 * arrays()["q"]))).v is not None


def test_velocity_is_not_judged_without_motion_or_when_it_is_only_noise():
    rng = np.random.default_rng(1)
    still = 1e-5 * rng.normal(size=(60, 2))
    assert Recording(**arrays(q=still, v=50.0 * still)).v is not None
    noise = 60.0 * rng.normal(size=(60, 2))
    assert Recording(**arrays(v=noise)).v is not None


def test_select_reorders_and_drops_joints_by_name():
    recording = Recording(**arrays(), source=Source("log.csv", "0" * 64))
    swapped = recording.select(["left_knee", "hip"])
    assert swapped.joint_names == ("left_knee", "hip")
    for name in ("q", "v", "a", "tau"):
        np.testing.assert_array_equal(getattr(swapped, name), getattr(recording, name)[:, ::-1])
    assert recording.select("hip").q.shape == (60, 1)
    assert swapped.source == recording.source


def test_select_refuses_an_unknown_joint_and_lists_what_exists():
    with pytest.raises(ExoidError, match="no joint 'ankle' in the recording; it has: hip, left_knee"):
        Recording(**arrays()).select(["hip", "ankle"])


def test_slices_by_row_and_by_time_agree_and_share_no_row():
    recording = Recording(**arrays())
    early, late = recording.between(-math.inf, TIME[20]), recording.between(TIME[20], math.inf)
    np.testing.assert_array_equal(np.concatenate([early.tau, late.tau]), recording.tau)
    np.testing.assert_array_equal(late.q, recording.slice(20).q)
    np.testing.assert_array_equal(recording.slice(-10).time, TIME[-10:])


def test_a_slice_that_leaves_too_little_is_refused():
    with pytest.raises(ExoidError, match="too few samples: 0"):
        Recording(**arrays()).between(50.0, 60.0)


def test_a_notebook_shows_the_ranges_of_each_joint():
    t = np.arange(100) / 50.0
    q = np.column_stack([0.5 * np.sin(3.0 * t), np.full(100, -0.25)])
    recording = Recording(time=t, q=q, tau=40.0 * q, joint_names=("hip", "<knee>"), source=Source("a&b.csv", "0" * 64))
    table = ET.fromstring(recording._repr_html_())
    assert table.findtext("caption") == "a&b.csv: 100 samples at 50 Hz, 1.98 s"
    assert [cell.text for cell in table.iter("th")] == ["joint", "q [rad]", "v [rad/s]", "a [rad/s²]", "tau [N·m]"]
    hip, knee = ([cell.text for cell in row] for row in table.find("tbody"))
    assert hip == ["hip", "-0.5 … 0.5", "not recorded", "not recorded", "-20 … 20"]
    assert knee == ["<knee>", "-0.25 … -0.25", "not recorded", "not recorded", "-10 … -10"]


def test_an_uneven_recording_in_memory_says_so_in_a_notebook():
    t = np.cumsum(np.where(np.arange(50) % 7, 0.01, 0.013))
    shown = Recording(time=t, q=np.zeros((50, 1)), joint_names=("knee",))._repr_html_()
    assert "Recording: 50 samples at 100 Hz, " in shown
    assert "s (uneven)</caption>" in shown


def test_data_of_many_samples_print_one_line():
    poses = Poses(np.zeros((5000, 2)), np.ones((5000, 2)), ("hip", "knee"))
    assert repr(poses) == "Poses(5000 poses; joints: hip, knee)"
    assert repr(Approaches(poses, poses)) == f"Approaches(below={poses!r}, above={poses!r})"
    motion = Recording(time=np.arange(5000) / 100.0, q=poses.q, joint_names=poses.joint_names)
    assert repr(FiniteDifference().kinematics(motion)) == "Kinematics(5000 samples, 2 joints, valid: 1 to 4999)"
