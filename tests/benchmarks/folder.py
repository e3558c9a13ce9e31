"""Identify from a folder of Parquet files that together are larger than the memory allowed for it.

``python tests/benchmarks/folder.py 50 1000000`` writes fifty files of a million samples of three joints each into a
temporary folder (2.8 GB), identifies them in a process of its own, and prints JSON with its peak of memory.
"""

import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import polars
from long_logs import long_log, truth
from rich.console import Console
from rich.progress import track

import exoid
from exoid import Recordings


def write(folder: Path, leg: exoid.Leg, number: int, samples: int) -> None:
    """Write one file."""
    log = long_log(leg, samples, number)
    columns = {"time": log.time}
    for k, name in enumerate(log.joint_names):
        columns |= {f"q_{name}": log.q[:, k], f"tau_{name}": log.tau[:, k]}
    polars.DataFrame(columns).write_parquet(folder / f"part.{number}.parquet")


def measure(folder: str) -> None:
    """Identify, and print time, peak of memory and the worst error."""
    leg, logs = exoid.load_leg("bleex"), Recordings.from_folder(folder)
    start = time.perf_counter()
    estimate = exoid.identify(leg, logs, check=False)
    figures = {
        "files": len(logs),
        "samples": sum(source.samples for source in estimate.inputs),
        "seconds": time.perf_counter() - start,
        "peak_megabytes": 1024e-6 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss,
        "worst_z": float(np.abs((estimate.values - truth(leg)) / estimate.std).max()),
    }
    print(json.dumps(figures))


def main(files: int, samples: int) -> None:
    """Write the files, and measure in another process."""
    leg = exoid.load_leg("bleex")
    with tempfile.TemporaryDirectory(prefix="exoid-") as folder:
        for number in track(range(files), "writing", console=Console(stderr=True), transient=True):
            write(Path(folder), leg, number, samples)
        size = sum(file.stat().st_size for file in Path(folder).iterdir())
        run = subprocess.run([sys.executable, __file__, folder], capture_output=True, text=True, check=True)
    print(json.dumps({**json.loads(run.stdout), "gigabytes_on_disk": 1e-9 * size}))


if __name__ == "__main__":
    if len(sys.argv) == 2:
        measure(sys.argv[1])
    else:
        main(int(sys.argv[1]), int(sys.argv[2]))
