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
from rich.console import Console
from rich.progress import track

import exoid
from exoid import Recordings
from exoid.torques import DEFAULT_TERMS, TorqueModel

RATE = 500.0
NOISE = (1.0, 0.7, 0.3)
"""Of the torques [N·m]."""


def truth(leg: exoid.Leg) -> np.ndarray:
    """The leg's own parameters, and friction, offset and rotors."""
    count = len(TorqueModel(leg, DEFAULT_TERMS).names)
    return np.append(leg.parameters, np.random.default_rng(0).uniform(0.2, 0.8, count - len(leg.parameters)))


def write(folder: Path, leg: exoid.Leg, number: int, samples: int) -> None:
    """Write one file: five harmonics a joint, and torques of the model with noise."""
    rng, names = np.random.default_rng(number), leg.joint_names
    stamps = np.arange(samples) / RATE
    model, omega = TorqueModel(leg, DEFAULT_TERMS), 2.0 * np.pi * 0.1 * np.arange(1, 6)
    amplitude, phase = rng.uniform(0.05, 0.2, (len(names), 5)), rng.uniform(0.0, 6.28, (len(names), 5))
    q, tau = np.zeros((2, samples, len(names)))
    for start in range(0, samples, 10_000):
        rows = slice(start, start + 10_000)
        angle = np.multiply.outer(stamps[rows], omega)[:, None, :] + phase
        q[rows] = (amplitude * np.sin(angle)).sum(-1)
        v, a = (amplitude * omega * np.cos(angle)).sum(-1), -(amplitude * omega**2 * np.sin(angle)).sum(-1)
        tau[rows] = model.regressor(q[rows], v, a) @ truth(leg)
    tau += rng.normal(scale=NOISE, size=tau.shape)
    columns = {"time": stamps}
    columns |= {f"q_{name}": q[:, k] for k, name in enumerate(names)}
    columns |= {f"tau_{name}": tau[:, k] for k, name in enumerate(names)}
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
