"""A folder of logs is identified in memory that does not grow with the number of files.

``python tests/benchmarks/folder.py 50 1000000`` does it with fifty million samples.
"""

import json
import subprocess
import sys
from pathlib import Path

import pytest

import exoid

pytest.importorskip("polars")
import folder

SCRIPT = Path(__file__).parent / "folder.py"
SAMPLES = 200_000
MEMORY = 1000.0
"""Megabytes of the whole process."""
GROWTH = 1.1
"""Of the peak, for twice the files, whose samples alone have 67 MB."""


def measured(logs: Path) -> dict[str, float]:
    run = subprocess.run([sys.executable, SCRIPT, logs], capture_output=True, text=True, check=True)
    figures = json.loads(run.stdout)
    print(f"\n{figures}")
    return figures


@pytest.mark.slow  # of memory, not of time: it need not run alone
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the peak is counted in kilobytes on Linux")
def test_memory_does_not_grow_with_the_number_of_files_and_the_estimate_is_right(tmp_path):
    leg, half, whole = exoid.load_leg("bleex"), tmp_path / "half", tmp_path / "whole"
    half.mkdir()
    whole.mkdir()
    for number in range(12):
        folder.write(whole, leg, number, SAMPLES)
    for file in sorted(whole.iterdir())[:6]:  # with three, readers have not met yet
        (half / file.name).hardlink_to(file)
    few, many = measured(half), measured(whole)
    assert many["samples"] == 2 * few["samples"] == 12 * SAMPLES
    assert many["peak_megabytes"] < min(MEMORY, GROWTH * few["peak_megabytes"])
    assert max(few["worst_z"], many["worst_z"]) < 4.5
