"""Identify a long recording and say how long it took and how much memory it needed beside the data.

``python tests/benchmarks/million.py 1000000`` prints JSON; run as a process of its own, so that the peak is its own.
``python tests/benchmarks/million.py 1000000 default`` does so with the default terms, which take reversals out.
"""

import json
import sys
import time
from pathlib import Path

import numpy as np
from long_logs import long_log, truth
from turns import looped

import exoid

LOOPED = 100_000
"""Samples that the loop is timed over."""

SMOOTH = (exoid.Coulomb(smoothing=0.015), exoid.Viscous(), exoid.Armature(), exoid.Offset())
"""Terms without the projection of reversals, which the default terms have."""


def of_loop(leg: exoid.Leg, samples: int, out: np.ndarray | None = None) -> float:
    """Seconds that a plain Python loop over Pinocchio's regressor takes for so many samples, kept or thrown away."""
    motion = np.random.default_rng(0).standard_normal((3, LOOPED, len(leg.joint_names)))
    start = time.process_time()
    looped(leg.model, motion, out)
    return (time.process_time() - start) * samples / LOOPED


def memory(name: str) -> float:
    """VmRSS or VmHWM of this process [MB]."""
    line = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith(name))
    return int(line.split()[1]) / 1e3


def main(samples: int, terms: tuple[exoid.torques.Term, ...] | None) -> None:
    """Print what was measured."""
    leg = exoid.load_leg("bleex")
    exoid.identify(leg, long_log(leg, 20_000), terms, check=False)  # whatever has to be imported
    log = long_log(leg, samples)
    out = np.full((LOOPED, len(leg.joint_names), 10 * len(leg.joint_names)), np.nan)
    before = memory("VmRSS")
    Path("/proc/self/clear_refs").write_text("5")  # the peak counts from here
    loops, stored, seconds = [of_loop(leg, samples)], [], []
    for _ in range(2):
        start = time.process_time()
        estimate = exoid.identify(leg, log, terms, check=False)
        seconds.append(time.process_time() - start)
        loops.append(of_loop(leg, samples))
        stored.append(of_loop(leg, samples, out))
    print(
        json.dumps(
            {
                "samples": samples,
                "megabytes": memory("VmHWM") - before,
                "data": 1e-6 * sum(x.nbytes for x in (log.time, log.q, log.tau)),
                "seconds": min(seconds),
                "loop": min(loops),
                "stored_loop": min(stored),
                "worst_z": float(np.abs((estimate.values - truth(leg)) / estimate.std).max()),
            }
        )
    )


if __name__ == "__main__":
    main(int(sys.argv[1]), None if sys.argv[2:] == ["default"] else SMOOTH)
