"""How long ``import exoid`` takes, against ``import pinocchio``, which is part of it: in fresh interpreters, in turns.

``pytest tests/benchmarks/test_import.py -s`` prints the times.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np

ROUNDS = 8
RATIO = 3.0
"""Above this something heavy has come into ``import exoid``."""

SCRIPT = "import time; start = time.process_time(); import {}; print(time.process_time() - start)"


def seconds(package: str, compiled: Path) -> float:
    """Processor time to import a package in an interpreter of its own, its modules compiled before."""
    command = [sys.executable, "-X", f"pycache_prefix={compiled}", "-c", SCRIPT.format(package)]
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    return float(subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout)


def test_importing_exoid_takes_at_most_a_few_times_as_long_as_importing_pinocchio(tmp_path):
    times = np.array([[seconds(package, tmp_path) for package in ("pinocchio", "exoid")] for _ in range(ROUNDS)])
    pinocchio, ours = times.min(axis=0)
    print(f"\nimport pinocchio: {1e3 * pinocchio:.0f} ms, import exoid: {1e3 * ours:.0f} ms, {ours / pinocchio:.2f} ×")
    assert ours <= RATIO * pinocchio
