"""Logs that were made to crash programs or to fill the memory: each ends in one line, and the caller goes on."""

import io
import itertools
import os
import signal
import struct
import subprocess
import sys
import time
import zipfile

import hostile_readers
import numpy as np
import polars
import pytest
from log_writers import WRITERS, messages, write_bag, write_bag1
from processes import run_python
from rosbags.rosbag2 import CompressionMode, StoragePlugin

from exoid import ExoidError, Recording
from exoid.signals.readers.table import MOST_COLUMNS
from exoid.tools import file_bounds, reader_process
from exoid.tools.reader_process import read_in_child

posix = pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
linux = pytest.mark.skipif(sys.platform != "linux", reason="only Linux bounds the memory of a process")


def swing(samples=200):
    time_ = np.arange(samples) / 100.0
    q = np.sin(np.outer(time_, [1.0, 2.0]))
    return Recording(time=time_, q=q, tau=np.cos(q), joint_names=("hip", "knee"))


def refused(path, match):
    with pytest.raises(ExoidError, match=match) as caught:
        Recording.from_file(path)
    assert str(caught.value).startswith(str(path))
    assert caught.value.remedy


# The child process


def test_one_child_serves_many_files_and_returns_what_readers_do(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    values = np.array(["hip", "knie ü"])
    first, second = (read_in_child(hostile_readers.echo, name, values=values) for name in ("a", "b"))
    assert (second["values"] == values).all()
    assert second == {**first, "file": "b", "values": second["values"]}
    assert first["folder"] == str(tmp_path)
    assert first["pid"] != os.getpid()


@pytest.mark.parametrize(
    ("reader", "arguments", "match"),
    [
        *(
            pytest.param(hostile_readers.die, {"number": int(each)}, rf"died \({each.name}\)", marks=posix)
            for each in (signal.SIGSEGV, signal.SIGABRT, signal.SIGKILL)
        ),
        pytest.param(hostile_readers.fill_memory, {}, "too large for the memory", marks=linux),
        (hostile_readers.leave, {}, r"log.bad: its reader died \(status 3\)"),
        (hostile_readers.refuse, {}, "^log.bad: bad. To fix it: mend it$"),
        (hostile_readers.fail, {}, "log.bad: cannot be read as a log: any other"),
    ],
)
def test_whatever_a_reader_does_ends_in_one_line_and_the_next_file_is_read(reader, arguments, match):
    with pytest.raises(ExoidError, match=match):
        read_in_child(reader, "log.bad", **arguments)
    assert read_in_child(hostile_readers.echo, "good")["file"] == "good"


@linux
def test_the_system_bounds_the_memory_beyond_the_present_one():
    """In a process of its own."""
    code = (
        "import numpy; from exoid.tools.reader_process import limited_memory\n"
        "with limited_memory(2**27):\n"
        "    numpy.ones(2**20)\n"
        "    try: numpy.ones(2**25)\n"
        "    except MemoryError: print('refused')\n"
        "print(numpy.ones(2**25).size)"
    )
    assert run_python(code).split() == ["refused", str(2**25)]


def test_a_reader_that_hangs_is_killed(monkeypatch):
    monkeypatch.setattr(reader_process, "most_seconds", lambda size: 0.5)
    with pytest.raises(ExoidError, match=r"log.bad: its reader has not ended within 0 s|within 1 s"):
        read_in_child(hostile_readers.hang, "log.bad")


@pytest.mark.slow
@posix
def test_the_child_ends_with_its_caller(tmp_path):
    WRITERS["log.mat"](tmp_path / "log.mat", swing())
    code = (
        "import sys, exoid, os; from exoid.tools.reader_process import _CHILDREN;"
        "exoid.Recording.from_file(sys.argv[1]); print(_CHILDREN[0].process.pid); sys.stdout.flush();"
        "os.kill(os.getpid(), 9) if sys.argv[2] == 'killed' else None"
    )
    for end in ("ended", "killed"):
        command = [sys.executable, "-c", code, str(tmp_path / "log.mat"), end]
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
        pid, until = int(done.stdout), time.monotonic() + 20.0
        while (state := _state(pid)) not in ("", "Z") and time.monotonic() < until:
            time.sleep(0.05)
        assert state in ("", "Z"), f"the child of a caller that {end} runs on"


def _state(pid):
    """State of a process; empty if there is none."""
    done = subprocess.run(["ps", "-o", "state=", "-p", str(pid)], capture_output=True, text=True, check=False)
    return done.stdout.strip()


# Files that crash their readers


def element(kind, data):
    return struct.pack("<II", kind, len(data)) + data + bytes(-len(data) % 8)


def variable(flags, shape, name, content):
    return element(14, element(6, struct.pack("<II", *flags)) + element(5, shape) + element(1, name) + content)


TIMES = element(9, np.arange(12.0).tobytes())
TIME = variable((6, 0), struct.pack("<ii", 12, 1), b"time", TIMES)


@pytest.mark.slow
@pytest.mark.parametrize(
    "content",
    [
        variable((4, 0), b"", b"time", element(16, b"")),
        variable((6 | 1 << 11, 0), struct.pack("<ii", 12, 1), b"time", TIMES) + TIME,
        variable((6, 0), struct.pack("<ii", 12, 1), b"time", element(14, TIMES)),
        variable((1, 0), struct.pack("<ii", 12, 1), b"time", TIMES),
        variable((2, 0), struct.pack("<ii", 12, 1), b"time", TIMES),
        variable((6, 0), struct.pack("<ii", 12, -1), b"time", TIMES),
        struct.pack("<II", 14, 10**6) + TIME,
        struct.pack("<II", 15, len(TIME)) + TIME,
        struct.pack("<II", 9, len(TIME)) + TIME,
        TIME[:-40],
        TIME[:60],
    ],
    ids=["no shape", "complex", "matrix", "cell", "struct", "negative", "long", "packed", "number", "cut", "cut early"],
)
def test_a_damaged_matlab_file_is_one_line_even_where_it_crashes_scipys_reader(content, tmp_path):
    """The first two are segmentation faults of a process that reads them."""
    (tmp_path / "log.mat").write_bytes(b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM" + content)
    refused(tmp_path / "log.mat", "log.mat")
    assert read_in_child(hostile_readers.echo, "good")["file"] == "good"


# Files that fill the memory


def header(shape, kind="<f8"):
    data = io.BytesIO()
    np.lib.format.write_array_header_1_0(data, {"descr": kind, "fortran_order": False, "shape": shape})
    return data.getvalue()


@pytest.mark.parametrize("shape", [(10**12, 0), (0, 10**12)])
def test_an_array_of_size_zero_has_no_million_million_columns(shape, tmp_path):
    with zipfile.ZipFile(tmp_path / "log.npz", "w") as archive:
        archive.writestr("time.npy", header((0,)))
        archive.writestr("q.npy", header(shape))
    refused(tmp_path / "log.npz", "time is empty")
    with zipfile.ZipFile(tmp_path / "log.npz", "w") as archive:
        archive.writestr("time.npy", header((20,)) + np.arange(20.0).tobytes())
        archive.writestr("q.npy", header(shape))
    refused(tmp_path / "log.npz", "no column")


def test_an_archive_that_expands_far_beyond_what_measurements_do_is_refused(tmp_path):
    """Two million samples in 40 kB: MB of noise compress by less than 10, this by 3000."""
    samples = file_bounds.MOST_MEMORY // 16 + 1
    with zipfile.ZipFile(tmp_path / "log.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("time.npy", header((samples,)) + bytes(8 * samples))
        archive.writestr("q.npy", header((samples, 1)) + bytes(8 * samples))
    refused(tmp_path / "log.npz", "not plausible for measurements")


@pytest.mark.parametrize("kind", ["csv", "parquet", "npz"])
def test_more_columns_than_any_robot_has_are_refused(kind, tmp_path):
    names = ["time", *(f"q_{k}" for k in range(MOST_COLUMNS))]
    path = tmp_path / f"log.{kind}"
    if kind == "csv":
        path.write_text(",".join(names) + "\n" + ("," * (len(names) - 1) + "\n") * 12)
    elif kind == "npz":
        np.savez(path, time=np.arange(12.0), q=np.zeros((12, MOST_COLUMNS)))
    else:
        polars.DataFrame({name: [0.0] for name in names}).write_parquet(path)
    refused(path, "10001 columns, more than 10000")


@pytest.mark.slow
@linux
@pytest.mark.parametrize("fault", ["sparse", "open quote"])
def test_a_csv_that_would_fill_the_memory_is_refused_in_300_mb(fault, tmp_path):
    path, comment = tmp_path / "log.csv", f"# {'x' * 10**6}\n"
    with path.open("w") as file:
        file.write("time,q_hip,tau_hip\n" + "".join(f"{k / 100},{k / 1000},1.0\n" for k in range(100)))
        if fault == "sparse":
            file.truncate(3 * 10**9)
        else:
            file.writelines([*itertools.repeat(comment, 300), '1.0,0.1,"1.0\n'])
    code = (
        "import exoid, re, sys\ntry:\n    exoid.Recording.from_file(sys.argv[1])\n"
        "except exoid.ExoidError as error:\n"
        # not ru_maxrss, which begins with the memory of the process that started this one
        r"    print(re.search(r'VmHWM:\s+(\d+)', open('/proc/self/status').read())[1], error)"
    )
    memory, _, message = run_python(code, path).partition(" ")
    assert message.startswith(str(path))
    assert int(memory) < 300_000  # kB


@pytest.mark.slow
@linux
@pytest.mark.parametrize("kind", ["mcap", "bag", "messages"])
def test_a_compressed_bag_that_would_fill_the_memory_is_refused(kind, tmp_path):
    """A thousand messages of 1 MB of zeros are a few 100 kB in the bag."""
    recording = swing()
    wide = [(stamp, names, np.zeros(100_000), *rest) for stamp, names, _, *rest in messages(recording)] * 6
    path = tmp_path / f"log.{kind}"
    if kind == "bag":
        write_bag1(path, wide, compress=True)
    else:
        mode = CompressionMode.MESSAGE if kind == "messages" else CompressionMode.STORAGE
        plugin = StoragePlugin.SQLITE3 if kind == "messages" else StoragePlugin.MCAP
        write_bag(path, {"/joints": wide}, plugin=plugin, compress=mode)
    size = file_bounds.size_on_disk(path)
    assert size < 10_000_000
    refused(path, "not plausible for measurements|too large for the memory|fill")
