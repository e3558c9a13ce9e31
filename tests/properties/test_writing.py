"""Writers that are killed, that run out of disk or of rights, or that meet another of their kind."""

import os
import signal
import subprocess
import sys
import textwrap
import time

import numpy as np
import pytest
from processes import full_disk

from exoid import Estimate, ExoidError, Leg, Recording

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals and limits of POSIX")

KILLS = 6 * (20 if os.environ.get("EXOID_FULL_STUDIES") == "1" else 1)

WRITER = textwrap.dedent(
    """
    import sys
    import numpy as np
    from exoid import Estimate, Recording
    estimate = Estimate.load("old.json")
    time = np.arange(20000) / 1000.0
    q = np.sin(np.outer(time, [1.0, 2.0, 3.0]))
    recording = Recording(time=time, q=q, tau=q, joint_names=("a", "b", "c"))
    print("ready", flush=True)
    while True:
        if "save" in sys.argv:
            estimate.save("new.json")
        if "export" in sys.argv:
            estimate.to_urdf("new.urdf")
        if "csv" in sys.argv:
            recording.to_csv("new.csv")
    """
)


@pytest.fixture
def folder(estimate, tmp_path):
    """A folder with an estimate to write again and again."""
    estimate.save(tmp_path / "old.json")
    return tmp_path


def writer(folder, *what):
    """Start a process that writes, and wait until it is about to."""
    process = subprocess.Popen([sys.executable, "-c", WRITER, *what], cwd=folder, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stdout.readline() == "ready\n"
    return process


def assert_whole(folder, estimate):
    """Whatever stands under its final name is complete."""
    if (folder / "new.json").exists():
        assert Estimate.load(folder / "new.json").values.tobytes() == estimate.values.tobytes()
    if (folder / "new.csv").exists():
        assert len(Recording.from_csv(folder / "new.csv")) == 20000
    if (folder / "new.urdf").exists():
        assert Leg.from_urdf(folder / "new.urdf").joint_names


@pytest.mark.parametrize("what", ["save", *(pytest.param(each, marks=pytest.mark.slow) for each in ("export", "csv"))])
def test_a_writer_that_is_killed_leaves_nothing_half_written(folder, estimate, what):
    rng = np.random.default_rng(KILLS)
    for _ in range(KILLS // 3):
        finished = {path.name for path in folder.iterdir() if not path.name.startswith(".")}
        process = writer(folder, what)
        time.sleep(rng.uniform(0.0, 0.3))
        process.send_signal(signal.SIGKILL)
        process.wait(30)
        process.stdout.close()
        assert_whole(folder, estimate)
        assert finished <= {path.name for path in folder.iterdir()}, "a finished file is gone"
    leftovers = [path for path in folder.iterdir() if path.suffix in (".part", ".before")]
    assert all(path.name.startswith(".") for path in leftovers)


WRITES = {
    "save": lambda estimate, folder: estimate.save(folder / "new.json"),
    "export": lambda estimate, folder: estimate.to_urdf(folder / "new.urdf"),
    "csv": lambda estimate, folder: _recording().to_csv(folder / "new.csv"),
}


def _recording():
    time_ = np.arange(2000) / 100.0
    return Recording(time=time_, q=np.sin(time_)[:, None], joint_names=("hip",))


@pytest.mark.parametrize("what", WRITES)
def test_a_full_disk_ends_in_one_line_and_leaves_nothing(estimate, tmp_path, what):
    with full_disk(), pytest.raises(ExoidError, match=r"new\.\w+: cannot be written: File too large") as caught:
        WRITES[what](estimate, tmp_path)
    assert "disk with free space" in str(caught.value)
    assert list(tmp_path.iterdir()) == []
