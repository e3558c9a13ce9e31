"""Whatever a file or an array holds, there is a result that can be trusted or one error of one line."""

import json
import math
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from cases import cases
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from log_writers import WRITERS
from lxml import etree
from outcomes import outcome

import exoid
from exoid import Estimate, ExoidError, Leg, Recording
from exoid.leg.catalog import urdf_folder
from exoid.leg.description import describe

HEADERS = ("time", "q_hip", "q_knee", "v_hip", "v_knee", "tau_hip", "tau_knee", "a_hip", "mode", "", "q_", "time ", "#")
ODD = (
    *("", "nan", "inf", "-inf", "1e400", "1e-400", "0x10", "1_0", "½", "1,5"),
    *('"', '"1"', "'", "None", "٣", "-", " ", "\0"),
)
NUMBERS = st.one_of(
    st.floats(allow_nan=True, allow_infinity=True).map(repr),
    st.floats(-1.0, 1.0).map(repr),
    st.integers(-(10**20), 10**20).map(str),
    st.sampled_from(ODD),
    st.text(max_size=4),
)


@st.composite
def tables(draw):
    """CSV that is nearly right: some header, time that nearly increases, and now and then an odd cell or line."""
    delimiter = draw(st.sampled_from([",", ";", "\t"]))
    header = draw(st.lists(st.sampled_from(HEADERS), min_size=1, max_size=8, unique=draw(st.booleans())))
    rows, step = draw(st.integers(0, 25)), draw(st.sampled_from([0.01, 1e-12, 0.0, 5.0, 1e9]))
    seed = draw(st.integers(0, 2**32 - 1))
    values = np.random.default_rng(seed).uniform(-1.0, 1.0, (rows, len(header)))
    if "time" in header:
        values[:, header.index("time")] = step * np.arange(rows)
    lines = [header, *([repr(float(x)) for x in row] for row in values)]
    for _ in range(draw(st.integers(0, 3))):
        line = lines[draw(st.integers(0, len(lines) - 1))]
        line[draw(st.integers(0, len(line) - 1))] = draw(NUMBERS)
    written = [delimiter.join(line) for line in lines]
    for _ in range(draw(st.integers(0, 2))):
        written.insert(draw(st.integers(0, len(written))), draw(st.one_of(st.text(max_size=12), st.just("# note"))))
    return draw(st.sampled_from(["\n", "\r\n", "\r"])).join(written)


def assert_sound(recording):
    """What every recording promises."""
    assert np.isfinite(recording.time).all()
    assert (np.diff(recording.time) > 0.0).all()
    assert len(recording) >= 10
    for values in (recording.q, recording.v, recording.a, recording.tau):
        assert values is None or (np.isfinite(values).all() and values.shape == (len(recording), recording.n_joints))
    assert np.abs(recording.q).max() <= recording.largest_angle


@cases(0.25)
@given(text=tables(), raw=st.binary(max_size=3), at=st.integers(0, 10**6))
def test_any_table_of_text_is_read_or_refused(text, raw, at):
    content = bytearray(text.encode("utf-8", "surrogateescape"))
    place = at % (len(content) + 1)
    content[place:place] = raw
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "log.csv"
        path.write_bytes(content)
        result = outcome(Recording.from_file, path)
        if isinstance(result, Recording):
            assert_sound(result)
            result.to_csv(path)
            again = Recording.from_csv(path, resample=False)
            assert again.q.tobytes() == result.q.tobytes()


@pytest.mark.slow
@cases(0.1)
@given(st.data())
def test_any_damaged_file_is_read_or_refused(data):
    """Bytes changed, cut off or put in: where no checksum covers them values may change, nothing else happens."""
    kind = data.draw(st.sampled_from(list(WRITERS)))
    time = np.arange(12) / 100.0
    recording = Recording(time=time, q=np.sin(time)[:, None], tau=np.cos(time)[:, None], joint_names=("hip",))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / kind
        WRITERS[kind](path, recording)
        files = [path] if path.is_file() else sorted(path.iterdir())
        file = data.draw(st.sampled_from(files))
        content = bytearray(file.read_bytes())
        for _ in range(data.draw(st.integers(1, 6))):
            start = data.draw(st.integers(0, len(content)))
            stop = start + data.draw(st.sampled_from([0, 1, 1, 1, 4, 100, 10**6]))
            content[start:stop] = data.draw(st.binary(max_size=4))
        file.write_bytes(content)
        result = outcome(Recording.from_file, path)
        if isinstance(result, Recording):
            assert_sound(result)


SHAPES = st.one_of(st.just(()), hnp.array_shapes(min_dims=1, max_dims=3, max_side=14))
ARRAYS = st.one_of(
    hnp.arrays(st.sampled_from([np.float64, np.float32, np.int64, np.uint8, np.bool_, np.complex128, "U3"]), SHAPES),
    hnp.arrays(np.float64, st.tuples(st.integers(8, 14), st.integers(1, 2)), elements=st.floats(-7.0, 7.0)),
    st.none(),
    st.text(max_size=3),
    st.lists(st.one_of(st.none(), st.floats(), st.text(max_size=2)), max_size=12),
)


@cases(0.2)
@given(
    time=st.one_of(ARRAYS, st.integers(8, 14).map(lambda n: np.arange(n) / 50.0)),
    q=ARRAYS,
    v=ARRAYS,
    tau=ARRAYS,
    joints=st.one_of(st.just(("hip",)), st.just(("hip", "knee")), st.lists(st.text(max_size=5), max_size=3)),
)
def test_any_arrays_make_a_sound_recording_or_are_refused(time, q, v, tau, joints):
    result = outcome(Recording, time=time, q=q, v=v, tau=tau, joint_names=joints)
    if isinstance(result, Recording):
        assert_sound(result)
        assert_sound(result.select(result.joint_names[:1]))
        even = outcome(result.resampled)
        assert isinstance(even, ExoidError) or even.is_uniform


URDF = (urdf_folder() / "bleex.urdf").read_text(encoding="utf-8")
TAGS = (
    *("link", "joint", "inertial", "mass", "inertia", "origin"),
    *("axis", "limit", "parent", "child", "dynamics", "mimic"),
)
NAMES = ("name", "type", "link", "value", "xyz", "rpy", "joint", "damping")


@st.composite
def urdfs(draw):
    """BLEEX with attributes, elements and their order changed at random."""
    root = etree.fromstring(URDF.encode())
    for _ in range(draw(st.integers(1, 4))):
        elements = [element for element in root.iter() if isinstance(element.tag, str)]
        element = draw(st.sampled_from(elements))
        what = draw(st.sampled_from(["attribute", "attribute", "attribute", "drop", "double", "rename", "add", "move"]))
        if what == "attribute" and element.attrib:
            name = draw(st.sampled_from(sorted(element.attrib)))
            others = [other.get(name) for other in elements if other.get(name)]
            element.set(name, draw(st.one_of(NUMBERS.filter(_fits_xml), st.sampled_from(others))))
        elif what == "rename":
            element.tag = draw(st.sampled_from(TAGS))
        elif what == "add":
            made = etree.SubElement(element, draw(st.sampled_from(TAGS)))
            for name in draw(st.sets(st.sampled_from(NAMES))):
                made.set(name, draw(NUMBERS.filter(_fits_xml)))
        elif element is not root and what != "attribute":
            if what == "double":
                element.addnext(etree.fromstring(etree.tostring(element, with_tail=False)))
            else:
                element.getparent().remove(element)
                if what == "move":
                    draw(st.sampled_from([e for e in root.iter() if isinstance(e.tag, str)])).append(element)
    return etree.tostring(root, encoding="unicode")


def _fits_xml(text):
    return all(character in "\t\n\r" or character.isprintable() for character in text)


@pytest.mark.slow
@cases(0.2)
@given(text=urdfs(), joints=st.sampled_from([None, ("left_hip", "left_knee"), ("left_knee",), ("left_wing",)]))
def test_any_urdf_is_a_leg_whose_regressor_is_pinocchios_dynamics_or_is_refused(text, joints):
    leg = outcome(lambda: Leg.from_description(describe(text), joints))
    if not isinstance(leg, Leg):
        return
    rng = np.random.default_rng(0)
    q, v, a = rng.uniform(-1.0, 1.0, (3, 4, len(leg.joint_names)))
    torque = leg.inverse_dynamics(q, v, a)
    W = leg.regressor(q, v, a)
    assert np.isfinite(torque).all()
    size = (np.abs(W) * np.abs(leg.parameters)).sum(-1).max(initial=0.0) + np.abs(torque).max(initial=0.0)
    np.testing.assert_allclose(W @ leg.parameters, torque, rtol=0.0, atol=1e-7 * size + 1e-12)


VALUES = st.one_of(
    st.none(),
    st.booleans(),
    st.floats(),
    st.integers(),
    st.just(10**400),
    st.text(max_size=4),
    st.lists(st.floats(allow_nan=False), max_size=3),
    st.dictionaries(st.text(max_size=3), st.floats(), max_size=2),
)


def _spoiled(draw, data):
    """JSON with one to three values, anywhere in it, replaced or dropped."""
    for _ in range(draw(st.integers(1, 3))):
        place = data
        while True:
            keys = sorted(place) if isinstance(place, dict) else range(min(len(place), 5))
            if not keys:
                break
            key = draw(st.sampled_from(list(keys)))
            if isinstance(place[key], (dict, list)) and place[key] and draw(st.booleans()):
                place = place[key]
                continue
            if isinstance(place, dict) and draw(st.booleans()):
                del place[key]
            else:
                place[key] = draw(VALUES)
            break
    return json.dumps(data)


@cache
def _example():
    """Text of an estimate."""
    data = exoid.datasets.bleex_swing()
    with tempfile.TemporaryDirectory() as folder:
        exoid.identify(data.leg, data.train).save(Path(folder) / "leg.json")
        return (Path(folder) / "leg.json").read_text(encoding="utf-8")


@cases(0.08)
@given(st.data())
def test_any_file_of_an_estimate_is_read_or_refused(data):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "leg.json"
        path.write_text(_spoiled(data.draw, json.loads(_example())), encoding="utf-8")
        result = outcome(Estimate.load, path)
        if isinstance(result, Estimate):
            assert str(result)
            assert np.isfinite(result.values).all()
            assert all(math.isfinite(value) for value in result.std)
