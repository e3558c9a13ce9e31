"""Wrenches, contacts and poses in log files: every format reads them, CSV keeps them exactly, mistakes are named."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from log_writers import write_columns
from scipy.io import savemat
from walking import Walk

import exoid
from exoid import BaseMotion, BasePose, ExoidError, Recording, Wrench
from exoid.signals import Column, WrenchFrame

N = 40
TIME = np.arange(N) / 50.0
PARTS = ("fx", "fy", "fz", "mx", "my", "mz")

RNG = np.random.default_rng(5)
FORCE, MOMENT = RNG.normal(size=(2, N, 3)) * np.array([30.0, 5.0])[:, None, None]
FORCE[:, 2] += 500.0
STANCE = np.arange(N) % 7 < 3


def recording(wrenches=None, contacts=None, base=None):
    q = 0.2 * np.sin(TIME)[:, None]
    return Recording(TIME, q, joint_names=("knee",), wrenches=wrenches, contacts=contacts, base=base)


def same(one, other):
    assert list(one.wrenches) == list(other.wrenches)
    for link, wrench in one.wrenches.items():
        twin = other.wrenches[link]
        assert wrench.columns.tobytes() == twin.columns.tobytes()
        assert wrench.point.tobytes() == twin.point.tobytes()
        assert wrench.axes == twin.axes
    assert list(one.contacts) == list(other.contacts)
    assert all(np.array_equal(values, other.contacts[link]) for link, values in one.contacts.items())


# --- CSV reads back exactly -------------------------------------------------------------------------------------------

finite = st.floats(-1e3, 1e3)
links = st.text(st.sampled_from("abwx_:@. é"), min_size=1, max_size=9).filter(lambda name: name == name.strip())


@st.composite
def wrenches(draw):
    """Any wrench whose line of force is not metres away."""
    force = np.array(draw(st.lists(st.tuples(finite, finite, finite), min_size=10, max_size=10)))
    arm = np.array(draw(st.tuples(*[st.floats(-1.0, 1.0)] * 3)))
    axes = draw(st.sampled_from(["link", "world"]))
    place = st.tuples(*[st.floats(-2.0, 2.0)] * 3)
    point = draw(st.lists(place, min_size=10, max_size=10) if axes == "world" and draw(st.booleans()) else place)
    return Wrench(force, np.cross(arm, force), point, axes)


@settings(deadline=None, max_examples=60)
@given(
    acting=st.dictionaries(links, wrenches(), max_size=3),
    contacts=st.dictionaries(links, st.lists(st.booleans(), min_size=10, max_size=10), max_size=2),
)
def test_any_wrenches_and_contacts_read_back_exactly(tmp_path_factory, acting, contacts):
    path = tmp_path_factory.mktemp("logs") / "log.csv"
    time = np.arange(10) * 0.1
    before = Recording(time, np.zeros((10, 1)), joint_names=("knee",), wrenches=acting, contacts=contacts)
    before.to_csv(path)
    same(Recording.from_csv(path, resample=False), before)


def test_lines_above_a_second_file_say_the_axes_and_payloads_that_it_has(tmp_path):
    """Wrenches of the laboratory in a file beside the log were read in axes of the link."""
    acting, weight = {"foot": Wrench(FORCE, MOMENT, (0.1, 0.0, 0.2), "world")}, exoid.Payload("knee", 3.0)
    recording().to_csv(tmp_path / "log.csv")
    dataclasses.replace(recording(acting), payloads=(weight,)).to_csv(tmp_path / "plate.csv")
    log = Recording.from_csv(tmp_path / "log.csv", beside=[tmp_path / "plate.csv"])
    same(log, recording(acting))
    assert log.payloads == (weight,)


def test_switches_in_a_file_of_another_rate_stay_switches(tmp_path):
    """They passed a low-pass and were refused as values other than 0 and 1."""
    recording().to_csv(tmp_path / "log.csv")
    fast = np.arange(5 * N) / 250.0
    write_columns(tmp_path / "switches.csv", time=fast, contact_foot=1.0 * (fast > 0.3))
    log = Recording.from_csv(tmp_path / "log.csv", beside=[tmp_path / "switches.csv"])
    np.testing.assert_array_equal(log.contacts["foot"], TIME > 0.3)


def test_a_pose_beside_an_imu_reads_back_exactly(tmp_path):
    walked = Walk(exoid.load_leg("cuhk"), seconds=12.0, sideways=0.2)
    position, turn = walked.pose
    log = walked.recording()
    from_pose = BaseMotion.from_pose(position, turn.as_quat(), walked.time, at=(0.1, 0.0, 0.2))
    for base in (from_pose, dataclasses.replace(log.base, pose=BasePose(position, turn.as_quat()))):
        whole = dataclasses.replace(log, base=base)
        whole.to_csv(tmp_path / "walk.csv")
        read = Recording.from_csv(tmp_path / "walk.csv")
        assert read.base.pose.columns.tobytes() == base.pose.columns.tobytes()
        assert read.base.columns.tobytes() == base.columns.tobytes()
        assert read.base.position.tobytes() == base.position.tobytes()


# --- Every format -----------------------------------------------------------------------------------------------------


def arrays():
    return {
        "time": TIME,
        "q": 0.2 * np.sin(TIME)[:, None],
        "joint_names": np.array(["knee"]),
        "wrench_left_foot": np.hstack([FORCE, MOMENT]),
        **{
            f"wrench_rail_{part}": column
            for part, column in zip(PARTS, 0.1 * np.hstack([FORCE, MOMENT]).T, strict=True)
        },
        "contact_left_foot": STANCE,
    }


FRAMES = {"left_foot": "link@0.05,0,-0.08", "rail": WrenchFrame("world", (0.0, 0.5, 1.0))}
EXPECTED = {
    "wrenches": {
        "left_foot": Wrench(FORCE, MOMENT, (0.05, 0.0, -0.08)),
        "rail": Wrench(0.1 * FORCE, 0.1 * MOMENT, (0.0, 0.5, 1.0), "world"),
    },
    "contacts": {"left_foot": STANCE},
}


@pytest.mark.parametrize("ending", ["npz", "mat", "parquet", "csv"])
def test_each_format_has_wrenches_as_columns_or_matrices_and_contacts_as_bools_or_numbers(tmp_path, ending):
    path = tmp_path / f"log.{ending}"
    if ending == "npz":
        np.savez(path, **arrays())
    elif ending == "mat":
        savemat(path, {**arrays(), "joint_names": np.array(["knee"], dtype=object)})
    else:
        columns = {name: values for name, values in arrays().items() if values.ndim == 1 and len(values) == N}
        columns |= {"q_knee": arrays()["q"][:, 0], "contact_left_foot": STANCE if ending == "parquet" else STANCE + 0}
        foot = dict(zip((f"wrench_left_foot_{part}" for part in PARTS), np.hstack([FORCE, MOMENT]).T, strict=True))
        write_columns(path, **columns, **foot)
    read = Recording.from_file(path, wrench_frames=FRAMES)
    assert set(read.wrenches) == {"left_foot", "rail"}
    same(read, recording({link: EXPECTED["wrenches"][link] for link in read.wrenches}, EXPECTED["contacts"]))
    (one,) = exoid.Recordings.from_files([path], wrench_frames=FRAMES)
    same(one, read)


def test_headers_units_and_signs_of_wrenches_are_mapped(tmp_path):
    names = ["time", "q_knee", "Fx", "Fy", "Fz [kN]", "Mx", "My", "Mz", "px", "py", "pz", "switch"]
    point = np.tile([500.0, 20.0, 0.0], (N, 1))
    force = FORCE * (1.0, 1.0, 1e-3)
    table = np.column_stack([TIME, 0.2 * np.sin(TIME), force, 1e3 * MOMENT, point, 5.0 * STANCE])
    path = write_columns(tmp_path / "plate.csv", **dict(zip(names, table.T, strict=True)))
    columns = {
        "wrench_left_foot_fx": "Fx",
        "wrench_left_foot_fy": "Fy",
        "wrench_left_foot_fz": Column("Fz [kN]", unit="kN"),
        **{f"wrench_left_foot_m{axis}": Column(f"M{axis}", scale=-1.0, unit="N·mm") for axis in "xyz"},
        **{f"wrench_left_foot_p{axis}": Column(f"p{axis}", unit="mm") for axis in "xyz"},
        "contact_left_foot": Column("switch", scale=0.2),
    }
    read = Recording.from_csv(path, columns=columns)
    wrench = read.wrenches["left_foot"]
    assert np.allclose(wrench.columns, np.hstack([FORCE, -MOMENT]))
    assert np.allclose(wrench.point, 1e-3 * point)
    assert wrench.axes == "world"
    assert np.array_equal(read.contacts["left_foot"], STANCE)
    with pytest.raises(ExoidError, match=r"column 'Fz \[kN\]' says kN, and would be read as wrench_left_foot_fz in N"):
        Recording.from_csv(path, columns={**columns, "wrench_left_foot_fz": "Fz [kN]"})
    with pytest.raises(ExoidError, match="'A' is not a unit of moment on a link"):
        Recording.from_csv(path, columns={**columns, "wrench_left_foot_mx": Column("Mx", unit="A")})


# --- Mistakes ---------------------------------------------------------------------------------------------------------


def test_a_moving_point_belongs_to_the_laboratory(tmp_path):
    points = dict.fromkeys(("wrench_left_foot_px", "wrench_left_foot_py", "wrench_left_foot_pz"), 0.1 * TIME)
    foot = dict(zip((f"wrench_left_foot_{part}" for part in PARTS), np.hstack([FORCE, MOMENT]).T, strict=True))
    path = write_columns(tmp_path / "log.csv", time=TIME, q_knee=0.1 * TIME, **foot, **points)
    assert Recording.from_csv(path, wrench_frames={"left_foot": "world"}).wrenches["left_foot"].moving_point
    for frame in ("link", "world@0,0,0"):
        with pytest.raises(ExoidError, match="the point of the wrench is given by columns wrench_left_foot_px"):
            Recording.from_csv(path, wrench_frames={"left_foot": frame})
