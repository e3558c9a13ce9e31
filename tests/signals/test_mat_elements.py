"""Tags of MATLAB files are checked before scipy's compiled reader, which takes them at their word, sees the file."""

from __future__ import annotations

import io
import struct
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
import scipy

from exoid import ExoidError
from exoid.signals import Recording
from exoid.signals.readers.mat_elements import readable_variables

TIME = np.arange(12) / 100.0
COLUMNS = {"time": TIME[:, None], "q_hip": np.sin(TIME)[:, None], "tau_hip": np.cos(TIME)[:, None]}
FLAGS, DIMENSIONS, NAME, NUMBERS = 16, 32, 40, 48
"""Where these begin after the header, in the variable ``time``."""


def written(content, **options):
    file = io.BytesIO()
    scipy.io.savemat(file, content, **options)
    return file.getvalue()


def changed(place, *words):
    """The file with 32-bit words of its first variable replaced."""
    data = bytearray(written(COLUMNS))
    struct.pack_into(f"<{len(words)}I", data, 128 + place, *words)
    return bytes(data)


COMPLEX = changed(FLAGS, 6 | 1 << 11)
"""As found by a property test after more than 30 000 cases: what follows is read as imaginary parts."""


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (COMPLEX, "class 6 of elements of types"),
        (changed(NUMBERS, 14), "class 6 of elements of types"),
        (changed(NUMBERS, 77), "class 6 of elements of types"),
        (changed(NUMBERS + 4, 10**6), "ends in the middle"),
        (changed(FLAGS, 1), "cells or fields where there should be 12"),
        (changed(FLAGS, 2), "class 2 of elements of types"),
        (changed(FLAGS - 8, 5), "without flags"),
        (changed(DIMENSIONS - 8, 9), "without dimensions"),
        (changed(NAME, 5 << 16 | 1), "a tag that holds 5 bytes"),
        (changed(0, 9), "a variable of type 9"),
        (written(COLUMNS)[:-40], "ends in the middle"),
        (written(COLUMNS, do_compression=True)[:-40], "ends in the middle"),
    ],
)
def test_a_variable_whose_elements_are_not_those_of_its_class_is_refused(data, words, tmp_path):
    (tmp_path / "log.mat").write_bytes(data)
    with pytest.raises(ExoidError, match=words) as caught:
        Recording.from_file(tmp_path / "log.mat")
    assert "\n" not in str(caught.value)
    assert "-v7" in caught.value.remedy


def test_what_scipy_crashes_on_is_refused(tmp_path):
    """In a process of its own, as it takes Python with it; a scipy that does better makes the check needless."""
    (tmp_path / "log.mat").write_bytes(COMPLEX)
    command = "import scipy.io, sys; scipy.io.loadmat(sys.argv[1])"
    done = subprocess.run([sys.executable, "-c", command, str(tmp_path / "log.mat")], capture_output=True, check=False)
    assert done.returncode != 0
    with pytest.raises(ValueError, match="class 6"):
        readable_variables(COMPLEX)


@pytest.mark.parametrize("compressed", [False, True])
def test_numbers_text_cells_and_structs_are_readable_and_the_rest_is_passed_over(compressed):
    deep = np.empty(2, dtype=object)
    deep[:] = "a", {"z": np.eye(2)}
    content = {
        "real": np.eye(3),
        "imaginary": np.eye(3) * 1j,
        "none": np.zeros((0, 0)),
        "yes": np.array([True]),
        "text": "left knee",
        "cells": deep,
        "fields": {"x": 1.0, "inner": {"y": deep}},
        "sparse": scipy.sparse.csc_array(np.eye(3)),
        "hidden": {"sparse": scipy.sparse.csc_array(np.eye(3))},
    }
    found = readable_variables(written(content, do_compression=compressed))
    assert found == ["real", "imaginary", "none", "yes", "text", "cells", "fields"]


def test_a_name_that_also_stands_for_something_else_is_passed_over():
    one, other = written({"x": np.eye(3)}), written({"x": scipy.sparse.csc_array(np.eye(3))})
    assert readable_variables(one) == ["x"]
    assert readable_variables(one + other[128:]) == []


def test_versions_4_and_7_3_are_left_to_scipy():
    assert readable_variables(written(COLUMNS, format="4")) is None
    assert readable_variables(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM" + bytes(400)) is None
    assert readable_variables(b"") is None


def test_every_sound_file_of_scipys_own_tests_is_readable():
    """Files by MATLAB 5 to 7.4 on machines of either byte order, if scipy was installed with its tests."""
    folder = Path(scipy.__file__).parent / "io" / "matlab" / "tests" / "data"
    sound = (b"\x00\x01IM", b"\x01\x00MI")
    files = [file for file in sorted(folder.glob("test*.mat")) if file.read_bytes()[124:128] in sound]
    if not files:
        pytest.skip("scipy was installed without its tests")
    for file in files:
        found = readable_variables(file.read_bytes())
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            names = {name for name in scipy.io.loadmat(file) if not name.startswith("__")}
        objects = ("sparse", "object", "func", "matstring")  # the last are strings as MATLAB's class, of SciPy 1.18
        passed_over = {name for name in names if any(word in name for word in objects)}
        assert set(found) == names - passed_over, file.name
