"""Read thousands of mutated files of each kind in a child process: none may crash it, fill its memory or take long.

    python scripts/mutate_files.py [--files 20000] [--kinds mat,parquet,…] [--seed 0]

A finding is a child that dies, uses more than 300 MB, or takes more than 20 s on one file, or an error that is no
ExoidError of one line. The file of each finding is kept in ``mutated/``; the exit status is their number. Each line
also has how many files were accepted and refused, the largest memory of the processes, and the longest time of a file.
"""

from __future__ import annotations

import argparse
import json
import resource
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

ROOT = Path(__file__).resolve().parents[1]

MOST_MEMORY, MOST_SECONDS = 300_000_000, 20.0
"""Largest memory of the process that reads [bytes], and longest time for one file [s]."""

KINDS = (
    "csv",
    "npz",
    "mat",
    "struct.mat",
    "parquet",
    "mcap",
    "db3",
    "bag",
    "urdf",
    "estimate",
    "stl",
    "ply",
    "mot",
    "forces.sto",
    "obj",
    "dae",
    "glb",
    "columns.toml",
    "drives.toml",
    "loops.toml",
    "loops.xml",
    "stride",
    "start",
    "metadata",
)
MESHES = ("stl", "ply", "obj", "dae", "glb")
"""Kinds that are meshes."""

INTERESTING = (0, 1, 0x7F, 0x80, 0xFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 10**12, 2**63 - 1, 2**64 - 1)
"""Numbers at which readers go wrong."""

WORDS = (b"1e308", b"nan", b"-inf", b"\n", b"\0", b"[", b"{", b'"', b"<", b",,,,", b"99999999999999999999", b"1e-320")
"""Texts at which readers go wrong."""


class Finding(NamedTuple):
    """A file that is read wrongly, and what happened."""

    kind: str
    what: str
    content: bytes


def seeds(folder: Path) -> dict[str, bytes]:
    """Write a small valid file of each kind, and read its bytes."""
    sys.path.insert(0, str(ROOT / "tests"))
    import closed_machines  # noqa: PLC0415 - a module of the tests
    import log_writers  # noqa: PLC0415
    import one_joint  # noqa: PLC0415
    import trimesh  # noqa: PLC0415
    from rosbags.rosbag2 import StoragePlugin  # noqa: PLC0415 - an extra

    import exoid  # noqa: PLC0415

    leg = one_joint.write_urdf(folder / "urdf")
    one_joint.write_urdf(folder / "one.urdf")
    log = one_joint.swing(leg, seconds=4.0)
    estimate = exoid.identify(leg, log)
    short = log.slice(0, 40)
    for name in ("csv", "read_by_columns.csv"):
        short.to_csv(folder / name)
    for kind, name in (
        ("npz", "log.npz"),
        ("mat", "log.mat"),
        ("struct.mat", "struct.mat"),
        ("parquet", "log.parquet"),
    ):
        log_writers.WRITERS[name](folder / kind, short)
    for kind, plugin in (("mcap", StoragePlugin.MCAP), ("db3", StoragePlugin.SQLITE3)):
        log_writers.write_bag(folder / f"{kind}_bag", {"/joints": log_writers.messages(short)}, plugin=plugin)
        next((folder / f"{kind}_bag").glob(f"*.{kind}")).rename(folder / kind)
    columns = log_writers.named_columns(short)
    angles = {name: np.rad2deg(x) for name, x in columns.items() if name.startswith(("q_", "v_"))}
    torques = {name: x for name, x in columns.items() if name.startswith("tau_")}
    log_writers.write_opensim(folder / "mot", columns["time"], angles | torques, degrees=True)
    vectors = {f"ground_force_1_{part}{axis}": 100.0 * short.q[:, 0] for part in "vpm" for axis in "xyz"}
    log_writers.write_opensim(folder / "forces.sto", short.time, vectors)
    log_writers.write_bag1(folder / "bag", log_writers.messages(short))
    for kind in ("estimate", "start"):
        estimate.save(folder / kind)
    log_writers.write_bag(folder / "bag_folder", {"/joints": log_writers.messages(short)}, plugin=StoragePlugin.MCAP)
    shutil.copy(folder / "bag_folder" / "metadata.yaml", folder / "metadata")
    phases = np.arange(0.0, 1.0, 0.1)
    rows = "".join(f"{x:g},{30 * np.sin(7 * x):.3g},{20 + 20 * np.cos(7 * x):.3g}\n" for x in phases)
    (folder / "stride").write_text(f"phase,hip_deg,knee_deg\n{rows}", encoding="utf-8")
    estimate.to_urdf(folder / "leg.urdf")
    (folder / "stl").write_bytes(
        bytes(80) + (2).to_bytes(4, "little") + np.arange(24, dtype="<f4").tobytes() + bytes(4)
    )
    (folder / "ply").write_bytes(
        b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        b"element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
    )
    box = trimesh.creation.box((0.1, 0.2, 0.3))
    box.visual = trimesh.visual.TextureVisuals(uv=np.zeros((8, 2)))
    for kind in ("obj", "glb"):
        box.export(folder / kind, file_type=kind)
    (folder / "dae").write_bytes(trimesh.exchange.dae.export_collada(box))
    columns = 'gaps = "split"\n[columns]\nq_hip = "q_hip:1.0:0.0:rad"\ntau_hip = "tau_hip:N·m"\n'
    (folder / "columns.toml").write_text(columns, encoding="utf-8")
    (folder / "drives.toml").write_text(
        '[hip]\ntype = "motor"\ntorque_constant = 0.1\nratio = 50.0\nrotor_inertia = 2e-5\nefficiency = 0.9\n'
    )
    machine = closed_machines.four_bar_knee(0)
    (folder / "loops.toml").write_text(machine.loops, encoding="utf-8")
    (folder / "loops.xml").write_text(closed_machines.to_mjcf(machine).to_xml(), encoding="utf-8")
    return {kind: (folder / kind).read_bytes() for kind in KINDS}


def mutated(content: bytes, rng: np.random.Generator) -> bytes:
    """Change bytes, numbers, stretches and words, every other time at one place, else at up to eight."""
    data = bytearray(content)
    for _ in range(int(rng.integers(1, 9)) if rng.integers(0, 2) else 1):
        place = int(rng.integers(0, len(data) + 1))
        way = int(rng.integers(0, 8))
        if way == 0 and place < len(data):
            data[place] ^= 1 << int(rng.integers(0, 8))
        elif way == 1:
            data[place : place + 1] = rng.bytes(1)
        elif way == 2:
            size = int(rng.choice([1, 2, 4, 8]))
            number = INTERESTING[int(rng.integers(0, len(INTERESTING)))] % 256**size
            data[place : place + size] = number.to_bytes(size, "little" if rng.integers(0, 2) else "big")
        elif way == 3:
            del data[place : place + int(rng.integers(1, 64))]
        elif way == 4:
            start = int(rng.integers(0, len(data) + 1))
            data[place:place] = data[start : start + int(rng.integers(1, 256))]
        elif way == 5:
            data[place : place + int(rng.integers(0, 9))] = WORDS[int(rng.integers(0, len(WORDS)))]
        elif way == 6 and rng.integers(0, 8) == 0:
            del data[place:]
        elif way == 7 and rng.integers(0, 8) == 0:
            data[place:place] = WORDS[int(rng.integers(0, len(WORDS)))] * int(rng.integers(2, 2000))
    return bytes(data)


def reader_of(kind: str, folder: Path) -> Callable[[Path], Any]:
    """Find the function that reads a file of a kind."""
    import exoid  # noqa: PLC0415
    from exoid.control.functions.walk import stride_flexion  # noqa: PLC0415
    from exoid.leg.loops import Loops  # noqa: PLC0415
    from exoid.view.scenes.meshes import load_mesh  # noqa: PLC0415

    sys.path.insert(0, str(ROOT / "tests"))
    leg = exoid.Leg.from_urdf(folder / "one.urdf")
    readers: dict[str, Callable[[Path], Any]] = {
        "urdf": exoid.Leg.from_urdf,
        "estimate": lambda path: str(exoid.Estimate.load(path)),
        "forces.sto": exoid.signals.read_opensim_forces,
        "columns.toml": _read_by_columns,
        "start": lambda path: _begin_on_line(path, leg),
        "metadata": lambda path: exoid.Recording.from_file(path.parent),
        "stride": lambda path: stride_flexion(path, 1.0),
        "drives.toml": lambda path: exoid.actuators.read_actuators(path, leg),
        **dict.fromkeys(("loops.toml", "loops.xml"), Loops.read),
        **dict.fromkeys(MESHES, lambda path: load_mesh(path, np.ones(3))),
    }
    return readers.get(kind, exoid.Recording.from_file)


def _begin_on_line(path: Path, leg: Any) -> object:  # noqa: ANN401 - a leg
    """Begin an estimate on line with what an earlier session saved, and go on for two seconds."""
    import one_joint  # noqa: PLC0415 - a module of the tests

    import exoid  # noqa: PLC0415

    log = one_joint.swing(leg, seconds=2.0)
    online = exoid.online.RecursiveEstimator(leg, start=exoid.Estimate.load(path), rate=log.sample_rate)
    online.update(log.q, None, None, log.tau)
    return online.estimate, online.findings


def _read_by_columns(path: Path) -> object:
    """Read a log by the columns of a file."""
    from exoid.cli.column_map import with_map  # noqa: PLC0415
    from exoid.cli.inputs import read_log  # noqa: PLC0415
    from exoid.cli.options import LogOptions  # noqa: PLC0415

    return read_log(str(path.with_name("read_by_columns.csv")), with_map(LogOptions(), str(path)))


def name_of(kind: str) -> str:
    """Name of a file of a kind, by which it is recognised."""
    names = {"estimate": "est.json", "urdf": "bad.urdf", "struct.mat": "log.mat"}
    names |= {"start": "start.json", "stride": "stride.csv", "metadata": "bag_folder/metadata.yaml"}
    return names.get(kind, f"log.{kind}")


def serve(kind: str, folder: Path) -> None:
    """Read the file that each line of standard input announces; print an error that should not be, and the memory."""
    import exoid  # noqa: PLC0415

    read, path = reader_of(kind, folder), folder / name_of(kind)
    print("ready", flush=True)  # the time of imports does not count
    for _ in sys.stdin:
        what, refused = "", False
        try:
            read(path)
        except exoid.ExoidError as error:
            refused = True
            if "\n" in str(error) or not error.what.strip():
                what = f"not one line: {error}"
        except ValueError as error:
            what, refused = ("", True) if kind in MESHES else (repr(error), False)
        except Exception as error:
            what = repr(error)
        print(json.dumps({"what": what[:500], "refused": refused, "memory": peak()}), flush=True)


def peak() -> int:
    """Largest memory of this process and of those that it has started [bytes]."""
    import psutil  # noqa: PLC0415 - an extra of the tests

    own = psutil.Process()  # its ru_maxrss would be at least that of the process that has started it
    ended = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024
    return int(max([ended, *(_high_water(process.pid) for process in (own, *own.children(recursive=True)))]))


def _high_water(pid: int) -> int:
    try:
        lines = Path(f"/proc/{pid}/status").read_text(encoding="ascii").splitlines()
    except OSError:
        return 0
    return next((int(line.split()[1]) * 1024 for line in lines if line.startswith("VmHWM")), 0)


@dataclass
class Largest:
    """Largest memory [bytes] and longest time [s] so far, of files that were read to their end, and refused ones."""

    refused: int = 0
    memory: int = 0
    seconds: float = 0.0


def findings(
    kind: str, seed: bytes, folder: Path, count: int, rng: np.random.Generator, largest: Largest
) -> Iterator[Finding]:
    """Let a child read mutated files, and start another one where it dies."""
    path, child = folder / name_of(kind), None
    for _ in range(count):
        content = mutated(seed, rng)
        path.write_bytes(content)
        child = child or _child(kind, folder)
        late, began = threading.Timer(MOST_SECONDS, child.kill), time.monotonic()
        late.start()
        reply = _ask(child)
        late.cancel()
        seconds = time.monotonic() - began
        if reply is not None:
            largest.refused += reply["refused"] and not reply["what"]
            largest.memory = max(largest.memory, reply["memory"])
            largest.seconds = max(largest.seconds, seconds)
        if reply is None:
            yield Finding(kind, f"status {child.wait()} after {seconds:.1f} s", content)
            child = None
        elif reply["what"]:
            yield Finding(kind, reply["what"], content)
        elif reply["memory"] > MOST_MEMORY:
            yield Finding(kind, f"{reply['memory'] / 1e6:.0f} MB", content)
            child.kill()
            child = None
    if child is not None:
        child.kill()
        child.wait()


def _child(kind: str, folder: Path) -> subprocess.Popen[str]:
    command = [sys.executable, "-W", "ignore", __file__, "--serve", kind, str(folder)]
    child = subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, cwd=ROOT
    )
    assert child.stdout is not None
    if child.stdout.readline() != "ready\n":
        raise RuntimeError(f"the reader of {kind} does not start: status {child.wait()}")
    return child


def _ask(child: subprocess.Popen[str]) -> dict[str, Any] | None:
    """Let the child read the file; None if it has ended."""
    assert child.stdin is not None
    assert child.stdout is not None
    try:
        child.stdin.write("\n")
        child.stdin.flush()
        line = child.stdout.readline()
    except OSError:
        return None
    return json.loads(line) if line else None


def main() -> int:
    """Mutate and read, and print a line for each kind."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--files", type=int, default=20_000)
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--keep", type=Path, default=Path("mutated"))
    parser.add_argument("--serve", nargs=2, metavar=("KIND", "FOLDER"))
    words = parser.parse_args()
    if words.serve:
        serve(words.serve[0], Path(words.serve[1]))
        return 0
    total = 0
    with tempfile.TemporaryDirectory() as name:
        contents = seeds(Path(name))
        for kind in words.kinds.split(","):
            began, count = time.monotonic(), 0
            rng = np.random.default_rng([words.seed, KINDS.index(kind)])
            largest = Largest()
            for finding in findings(kind, contents[kind], Path(name), words.files, rng, largest):
                words.keep.mkdir(exist_ok=True)
                (words.keep / f"{count}-{Path(name_of(kind)).name}").write_bytes(finding.content)
                print(f"  {kind}: {finding.what}", flush=True)
                count += 1
            print(
                f"{kind}: {words.files} files in {time.monotonic() - began:.0f} s, {count} findings; "
                f"{words.files - largest.refused - count} accepted, {largest.refused} refused; "
                f"at most {largest.memory / 1e6:.0f} MB, {largest.seconds:.2f} s a file",
                flush=True,
            )
            total += count
    return min(total, 100)


if __name__ == "__main__":
    sys.exit(main())
