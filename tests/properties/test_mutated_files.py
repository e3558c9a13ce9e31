"""Mutated files of every kind end in a result or one line; ``scripts/mutate_files.py`` reads 20 000 of each."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[2] / "scripts" / "mutate_files.py"

FILES = 20_000 if os.environ.get("EXOID_FULL_STUDIES") == "1" else 25


@pytest.mark.nightly
@pytest.mark.skipif(sys.platform != "linux", reason="measures memory in /proc")
@pytest.mark.parametrize(
    "kinds",
    [
        "csv,npz,mat,struct.mat,parquet",
        "mcap,db3,bag",
        "urdf,estimate,sidecar,stl,ply",
        "mot,forces.sto,c3d",
        "columns.toml,drives.toml,state",
    ],
)
def test_no_mutated_file_crashes_the_caller_or_fills_its_memory(kinds, tmp_path):
    command = [sys.executable, str(SCRIPT), "--files", str(FILES), "--kinds", kinds, "--seed", "7"]
    done = subprocess.run([*command, "--keep", str(tmp_path)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count(f"{FILES} files in") == kinds.count(",") + 1
