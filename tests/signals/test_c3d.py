"""Force plates of C3D trials: axes of laboratory and plate, units, rates, and what is refused."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from log_writers import write_c3d, write_opensim
from test_opensim import plate as opensim_columns
from test_opensim import step

import exoid
from exoid import ExoidError, Recording
from exoid.errors import NotSupportedError, UnreadableInputError
from exoid.signals import read_opensim_forces

pytest.importorskip("ezc3d")

FAST = np.arange(2000) / 1000.0
Z_UP = np.array([[400.0, 500.0, 0.0], [0.0, 500.0, 0.0], [0.0, 0.0, 0.0], [400.0, 0.0, 0.0]])
"""Corners of a plate whose x axis is that of the laboratory, z up [mm]; its y axis points to -y, its z axis down."""

LABORATORIES = {  # corners [mm], laboratory from plate, laboratory from exoid's axes, forward axis
    "z up, x forward": (Z_UP, np.diag([1.0, -1.0, -1.0]), np.eye(3), "+x"),
    "z up, y forward": (Z_UP, np.diag([1.0, -1.0, -1.0]), np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]), "+y"),
    "z up, against x": (Z_UP, np.diag([1.0, -1.0, -1.0]), np.diag([-1.0, -1.0, 1.0]), "-x"),
    "y up, as in OpenSim": (  # the plate's x axis is z of the laboratory
        np.array([[300.0, 0.0, 100.0], [300.0, 0.0, -500.0], [-100.0, 0.0, -500.0], [-100.0, 0.0, 100.0]]),
        np.array([[0.0, -1, 0], [0, 0, -1], [1, 0, 0]]),
        np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]),
        "+x",
    ),
}


def sensor(corners, from_plate, from_exoid, transducer=(5.0, -8.0, 40.0), wrench=None):
    """A plate and its six channels under a wrench in exoid's axes: force, point, free moment."""
    force, point, moment = step(FAST) if wrench is None else wrench
    middle = corners.mean(axis=0) / 1000.0
    to_plate = from_plate.T @ from_exoid
    arm = (from_exoid @ point.T).T - middle - from_plate @ np.asarray(transducer) / 1000.0
    about = moment @ to_plate.T + np.cross(arm @ from_plate, force @ to_plate.T)
    return corners, np.asarray(transducer), np.vstack([(force @ to_plate.T).T, 1000.0 * about.T])


def ordered(corners, from_plate):
    """Corners in C3D's order: those at (+x +y), (-x +y), (-x -y), (+x -y) of the plate's axes."""
    inside = (corners - corners.mean(axis=0)) @ from_plate
    return corners[[int((inside[:, :2] @ way).argmax()) for way in ([1, 1], [-1, 1], [-1, -1], [1, -1])]]


@pytest.mark.parametrize("name", LABORATORIES)
def test_a_plate_gives_the_same_wrench_as_the_file_of_opensim(tmp_path, name):
    """Kinematics at 100 Hz; the wrench about the laboratory's origin, as the points differ."""
    corners, from_plate, from_exoid, forward = LABORATORIES[name]
    write_c3d(tmp_path / "walk.c3d", [sensor(ordered(corners, from_plate), from_plate, from_exoid)])
    write_opensim(tmp_path / "grf.mot", FAST, opensim_columns(*step(FAST)))
    time = np.arange(200) / 100.0
    motion = Recording(time, 0.3 * np.sin(time)[:, None], joint_names=("knee",))
    found, expected = (
        read_opensim_forces(path).attached_to(motion, {"1": "foot"}).wrenches["foot"].about((0.0, 0.0, 0.0))
        for path in (f"{tmp_path / 'walk.c3d'}:{forward}", tmp_path / "grf.mot")
    )
    assert np.abs(expected.force).max() > 600.0
    np.testing.assert_allclose(found.columns, expected.columns, atol=2e-3)  # channels are float32


def test_plates_are_numbered_and_every_length_is_read_in_metres(tmp_path):
    """An empty second plate; a trial in m and N·m."""
    corners, from_plate, from_exoid, _ = LABORATORIES["z up, x forward"]
    corners = ordered(corners, from_plate)
    loaded, empty = sensor(corners, from_plate, from_exoid), (corners + 600.0, np.zeros(3), np.zeros((6, len(FAST))))
    write_c3d(tmp_path / "walk.c3d", [loaded, empty])
    both = read_opensim_forces(f"{tmp_path / 'walk.c3d'}:+X").wrenches
    assert list(both) == ["1", "2"]
    assert not both["2"].force.any()
    np.testing.assert_allclose(both["1"].point, [0.2, 0.25, 0.0], atol=1e-6)
    channels = loaded[2] * np.repeat([1.0, 1e-3], 3)[:, None]
    write_c3d(tmp_path / "si.c3d", [(corners / 1e3, loaded[1] / 1e3, channels)], units=("m", "N", "Nm"))
    si = read_opensim_forces(f"{tmp_path / 'si.c3d'}:+x").wrenches["1"]
    np.testing.assert_allclose(si.columns, both["1"].columns, atol=1e-3)


def test_eight_channels_of_a_plate_with_four_feet_are_its_wrench(tmp_path):
    """Type 3: vertical forces at (±a, ±b), horizontal forces in pairs, all at a depth below the top."""
    a, b, depth = 120.0, 200.0, 50.0
    rng = np.random.default_rng(5)
    pair, ones = rng.normal(scale=20.0, size=(4, len(FAST))), np.ones(len(FAST))
    vertical = -200.0 * ones + rng.normal(scale=10.0, size=(4, len(FAST)))
    corners, from_plate, _, _ = LABORATORIES["z up, x forward"]
    write_c3d(
        tmp_path / "kistler.c3d",
        [(ordered(corners, from_plate), np.array([-a, -b, depth]), np.vstack([pair, vertical]))],
        types=[3],
    )
    found = read_opensim_forces(f"{tmp_path / 'kistler.c3d'}:+x").wrenches["1"]
    force, moment = np.zeros((len(FAST), 3)), np.zeros((len(FAST), 3))
    # x12 at y = +b, x34 at y = -b; y14 at x = +a, y23 at x = -a; feet 1 to 4 turn from (+a, +b) to (+a, -b)
    parts = [(0, 0.0, b, pair[0]), (0, 0.0, -b, pair[1]), (1, a, 0.0, pair[2]), (1, -a, 0.0, pair[3])]
    feet = ((a, b), (-a, b), (-a, -b), (a, -b))
    parts += [(2, x, y, each) for (x, y), each in zip(feet, vertical, strict=True)]
    for axis, x, y, size in parts:
        one = np.zeros((len(FAST), 3))
        one[:, axis] = size
        force += one
        moment += np.cross([x / 1e3, y / 1e3, depth / 1e3], one)
    np.testing.assert_allclose(found.force, force @ from_plate.T, atol=1e-3)
    np.testing.assert_allclose(found.moment, moment @ from_plate.T, atol=1e-3)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"first": 119}, "begins at frame 120"),
        ({"types": [4]}, "plate 1 of type 4"),
        ({"units": ("mm", "N", "Nm")}, "has channels in ['N', 'N', 'N', 'Nm', 'Nm', 'Nm'], positions in mm"),
        ({"units": ("mm", "V", "V")}, "channels in ['V'"),
        ({"units": ("in", "N", "Nin")}, "positions are in 'in'"),
        ({"corners": np.zeros((3, 4, 1))}, "corners of plate 1 are missing"),
        ({"corners": Z_UP.T[:, :, None]}, "corners of plate 1 are missing or in another"),
        ({"corners": np.zeros((3, 4, 0))}, "CORNER"),
    ],
)
def test_a_plate_whose_wrench_is_not_certain_is_refused(tmp_path, change, words):
    corners, from_plate, from_exoid, _ = LABORATORIES["z up, x forward"]
    write_c3d(tmp_path / "walk.c3d", [sensor(ordered(corners, from_plate), from_plate, from_exoid)], **change)
    with pytest.raises(UnreadableInputError) as caught:
        read_opensim_forces(f"{tmp_path / 'walk.c3d'}:+x")
    assert words in str(caught.value)
    assert caught.value.remedy


def test_the_force_on_the_plate_the_vertical_and_a_silent_axis_are_refused(tmp_path):
    corners, from_plate, from_exoid, _ = LABORATORIES["z up, x forward"]
    plate = sensor(ordered(corners, from_plate), from_plate, from_exoid)
    write_c3d(tmp_path / "walk.c3d", [plate])
    write_c3d(tmp_path / "action.c3d", [(*plate[:2], -plate[2])])
    for name, words in (
        ("action.c3d:+x", "pulls by 700 N: it has the force on it"),
        ("walk.c3d:+z", "the vertical"),
        ("walk.c3d", "nobody says which axis"),
    ):
        with pytest.raises(ExoidError, match=words):
            read_opensim_forces(tmp_path / name)


@pytest.mark.parametrize("name", ["walk.c3d", "walk.trc"])
def test_markers_are_no_joint_angles(tmp_path, name):
    (tmp_path / name).write_bytes(b"\x02\x50" + bytes(600))
    with pytest.raises(NotSupportedError, match=r"inverse kinematics"):
        exoid.Recording.from_file(tmp_path / name)


def test_a_damaged_trial_is_one_line(tmp_path):
    corners, from_plate, from_exoid, _ = LABORATORIES["z up, x forward"]
    write_c3d(tmp_path / "walk.c3d", [sensor(ordered(corners, from_plate), from_plate, from_exoid)])
    (tmp_path / "walk.c3d").write_bytes((tmp_path / "walk.c3d").read_bytes()[:1500])
    with pytest.raises(UnreadableInputError, match=r"walk.c3d") as caught:
        read_opensim_forces(f"{tmp_path / 'walk.c3d'}:+x")
    assert "\n" not in str(caught.value)


def test_a_trial_without_a_sample_of_its_plates_is_refused(tmp_path):
    """The rate of the channels has another name: ezc3d finds none of them."""
    corners, from_plate, from_exoid, _ = LABORATORIES["z up, x forward"]
    write_c3d(tmp_path / "walk.c3d", [sensor(ordered(corners, from_plate), from_plate, from_exoid)])
    content = (tmp_path / "walk.c3d").read_bytes()
    rate = content.index(b"RATE", content.index(b"ANALOG"))
    (tmp_path / "walk.c3d").write_bytes(content[:rate] + b"X" + content[rate + 1 :])
    with pytest.raises(UnreadableInputError, match="no sample"):
        read_opensim_forces(f"{tmp_path / 'walk.c3d'}:+x")


@pytest.mark.skipif(sys.platform != "linux", reason="bounds the memory of the reader otherwise")
def test_a_trial_that_claims_far_more_than_it_holds_fills_no_memory(tmp_path):
    """Names of channels with 18 dimensions in place of two, 1e33 of them: ezc3d took 370 MB before it gave up."""
    corners, from_plate, from_exoid, _ = LABORATORIES["z up, x forward"]
    write_c3d(tmp_path / "walk.c3d", [sensor(ordered(corners, from_plate), from_plate, from_exoid)])
    content = bytearray((tmp_path / "walk.c3d").read_bytes())
    names = content.index(b"LABELS", content.index(b"ANALOG")) + len("LABELS") + 2  # behind the offset to the next
    assert (content[names], content[names + 1]) == (255, 2)  # text of two dimensions
    content[names + 1] = 18
    (tmp_path / "claims.c3d").write_bytes(content)
    code = (
        "import psutil, sys, exoid\n"
        "try: exoid.signals.read_opensim_forces(sys.argv[1])\n"
        "except exoid.ExoidError as error: print(error.where, '|', end=' ')\n"
        "for child in psutil.Process().children():\n"
        "    lines = open(f'/proc/{child.pid}/status').read().splitlines()\n"
        "    print(*(line.split()[1] for line in lines if line.startswith('VmHWM')))"
    )
    for name in ("walk", "claims"):
        command = [sys.executable, "-c", code, f"{tmp_path / name}.c3d:+x"]
        said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        assert ("claims.c3d" in said) == (name == "claims")
        assert 20 < int(said.split()[-1]) / 1024 < 250  # MB, most of them libraries
