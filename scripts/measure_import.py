"""Measure what exoid costs before it does anything: ``import exoid`` and ``exoid --help``, beside what they stand on.

    python scripts/measure_import.py --runs 15

Commands of a pair run in turn, each in a process of its own, after a run of each that is not counted: bytecode and
the disk's cache are warm. A ratio is the median of the ratios of the pairs. CPU time is that of user and system.
"""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

BARE_APP = '''
import typer

app = typer.Typer()


@app.command()
def first(number: int = 1) -> None:
    """Do the first."""


@app.command()
def second(number: int = 1) -> None:
    """Do the second."""


app()
'''

EXOID = ("-c", "from exoid.cli import main; main()")
PINOCCHIO = ("-c", "import pinocchio")


class Cost(NamedTuple):
    """Time on the clock and of the processor [s]."""

    wall: float
    cpu: float


def pairs(bare_app: str) -> dict[str, tuple[tuple[str, ...], tuple[str, ...]]]:
    """Arguments of Python for what is measured and for what it stands beside.

    Args:
        bare_app: File of an application that has nothing but Typer.

    Returns:
        Both commands, by what their ratio says.
    """
    return {
        "import exoid / import pinocchio": (("-c", "import exoid"), PINOCCHIO),
        "exoid.load_leg, exoid.identify / import pinocchio": (
            ("-c", "import exoid; exoid.load_leg, exoid.identify"),
            PINOCCHIO,
        ),
        "every name of exoid / import pinocchio": (
            ("-c", "import exoid; [getattr(exoid, name) for name in exoid.__all__]"),
            PINOCCHIO,
        ),
        "exoid --help / a bare Typer application's": ((*EXOID, "--help"), (bare_app, "--help")),
        "exoid identify --help / a bare Typer application's": (
            (*EXOID, "identify", "--help"),
            (bare_app, "first", "--help"),
        ),
    }


def measure(arguments: tuple[str, ...]) -> Cost:
    """Run Python once.

    Args:
        arguments: What follows ``python``.

    Returns:
        What the process cost.
    """
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    cpu, wall = _of_children(), time.perf_counter()
    subprocess.run([sys.executable, *arguments], env=environment, stdout=subprocess.DEVNULL, check=True)
    return Cost(time.perf_counter() - wall, _of_children() - cpu)


def _of_children() -> float:
    """Processor time of all processes that were started and have ended [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main() -> None:
    """Print medians of both commands of each pair, and of their ratio."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=9, help="Runs of each command that count.")
    runs = parser.parse_args().runs
    with tempfile.TemporaryDirectory() as folder:
        bare_app = Path(folder, "bare_app.py")
        bare_app.write_text(BARE_APP, encoding="utf-8")
        print(f"{'median of ' + str(runs) + ' runs':<52} wall ms        ratio   CPU ms         ratio")
        for name, (ours, theirs) in pairs(str(bare_app)).items():
            costs = [(measure(ours), measure(theirs)) for _ in range(runs + 1)][1:]
            columns = []
            for kind in range(2):
                mine, base = ([1e3 * pair[k][kind] for pair in costs] for k in range(2))
                ratio = statistics.median(a / b for a, b in zip(mine, base, strict=True))
                columns.append(f"{statistics.median(mine):5.0f} /{statistics.median(base):5.0f}  {ratio:5.2f}")
            print(f"{name:<52} {'    '.join(columns)}")


if __name__ == "__main__":
    main()
