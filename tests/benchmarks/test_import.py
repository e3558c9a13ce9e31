"""How long ``import exoid`` takes, and its first use, against ``import pinocchio``: in fresh interpreters, in turns.

``pytest tests/benchmarks/test_import.py -s`` prints them; ``scripts/measure_import.py`` has those of whole processes.
"""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np

ROUNDS = 5
RATIO = 1.5
"""Above this something heavy has come into ``import exoid``."""

FIRST_USE = 3.5
"""The same for a leg and its identification, which need Pinocchio (2.3 to 2.8 measured)."""

SCRIPT = "import time; start = time.process_time(); {}; print(time.process_time() - start)"
STATEMENTS = ("import pinocchio", "import exoid", "import exoid; exoid.load_leg, exoid.identify")


def seconds(statement: str, compiled: Path) -> float:
    """Processor time of a statement in an interpreter of its own, what it imports compiled before."""
    command = [sys.executable, "-X", f"pycache_prefix={compiled}", "-c", SCRIPT.format(statement)]
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    return float(subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout)


def test_importing_exoid_takes_no_longer_than_it_must(tmp_path):
    times = np.array([[seconds(statement, tmp_path) for statement in STATEMENTS] for _ in range(ROUNDS)])
    # ratios are of one round, as a shared processor changes its speed
    pinocchio, ours, used = np.median(times[:, :1]) * np.median(times / times[:, :1], axis=0)
    print(f"\nimport pinocchio: {1e3 * pinocchio:.0f} ms, import exoid: {1e3 * ours:.0f} ms, {ours / pinocchio:.2f} ×")
    print(f"with a leg and its identification: {1e3 * used:.0f} ms, {used / pinocchio:.2f} ×")
    assert ours <= RATIO * pinocchio
    assert used <= FIRST_USE * pinocchio
