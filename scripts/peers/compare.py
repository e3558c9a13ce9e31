"""One table of exoid and its peers on the same logs: work, torque, parameters, intervals, time, export.

Logs: the simulated swing of BLEEX's left leg (seed 1 is ``bleex_swing``; seeds differ in motion and noise), and the
DFKI double pendulum, a real arm. All models are judged by the same filtered samples of a test log that no peer has
seen.

lines      lines that a user writes beyond "urdf and log are read": between the marks in ``with_<peer>.py``, and YAML
swing, DFKI  NRMSE of the torque on the test log, each joint; swing is the log ``bleex_swing``
X, J; c, d  worst error of X1 to X3 and J1 to J3, and of dry and viscous friction, relative to the truth; median of
           the seeds
coverage   share of the peer's 95 % intervals that contain the true values of the peer's own parameters, over the seeds
time       seconds of identification of ``bleex_swing`` as ratio to exoid's, in turns; one thread each

    python -m venv peers && peers/bin/pip install . -r scripts/peers/requirements.txt
    OMP_NUM_THREADS=1 peers/bin/python -W ignore scripts/peers/compare.py --peers figaroh mujoco_regressor  # minutes
    OMP_NUM_THREADS=1 peers/bin/python -W ignore scripts/peers/compare.py --peers mujoco --seeds 5  # half an hour
"""

from __future__ import annotations

import argparse
import importlib
import sys
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

import numpy as np
from task import Outcome, Task, nrmse, pendulum, read_as_parameters, swing

from exoid._typing import FloatArray

PEERS = {"exoid": "exoid", "figaroh": "figaroh", "mujoco": "mujoco", "mujoco_regressor": "mujoco-sysid"}
"""Distribution of each peer, whose version is printed."""
TITLES = {"mujoco": "mujoco.sysid"}
CONFIGURATIONS = {"figaroh": "figaroh.yaml"}
TURNS = 3
SLOW = 20.0
"""Time from which on a peer is timed once [s]."""


class Seed(NamedTuple):
    """Result of one simulated log: errors relative to the truth, and which intervals contain it."""

    inertial: float
    friction: float
    inside: FloatArray


def judged(task: Task, outcome: Outcome) -> Seed:
    """Compare a model with the truth.

    Args:
        task: The task.
        outcome: What the peer found.

    Returns:
        Errors and coverage.
    """
    assert task.truth is not None
    found, true = (read_as_parameters(task.leg, torque) for torque in (outcome.torque, task.truth))
    error = {name: abs(found[name] / true[name] - 1.0) for name in true}
    inside = np.empty(0)
    if outcome.half_widths is not None and outcome.true_values is not None:
        inside = np.abs(outcome.values - outcome.true_values) <= outcome.half_widths
    rigid = [error[name] for name in error if name[0] in "XJ"]
    return Seed(max(rigid), max(error[name] for name in error if name[0] in "cd"), inside)


def lines(peer: str) -> int:
    """Count the lines that a user writes, without blank ones and docstrings.

    Args:
        peer: The peer.

    Returns:
        Number of lines.
    """
    folder = Path(__file__).parent
    parts = (folder / f"with_{peer}.py").read_text(encoding="utf-8").split("# user: begins\n")[1:]
    text = [line.strip() for part in parts for line in part.split("# user: ends")[0].splitlines()]
    if peer in CONFIGURATIONS:
        text += (folder / CONFIGURATIONS[peer]).read_text(encoding="utf-8").splitlines()
    return sum(bool(line) and not line.startswith(('"""', "#")) for line in text)


def row(peer: str, seeds: int, seconds: dict[str, float]) -> list[str]:
    """Run a peer.

    Args:
        peer: The peer.
        seeds: Number of simulated logs.
        seconds: Time of each peer on the log of seed 1 [s].

    Returns:
        Cells of the table.
    """
    identify = importlib.import_module(f"with_{peer}").identify
    results, cells = [], [f"{TITLES.get(peer, PEERS[peer])} {version(PEERS[peer])}", str(lines(peer))]
    for seed in range(1, seeds + 1):
        task = swing(seed)
        outcome = identify(task, task.train)
        results.append(judged(task, outcome))
        print(f"{peer} seed {seed}: {results[-1][:2]}, {results[-1].inside.mean():.2f}", file=sys.stderr, flush=True)
        if seed == 1:
            first = (nrmse(task, outcome.torque), outcome.export)
    real = pendulum()
    real_error = nrmse(real, identify(real, real.train).torque)
    inside = np.concatenate([each.inside for each in results])
    cells += [_joined(errors) for errors in (first[0], real_error)]
    for errors in zip(*(each[:2] for each in results), strict=True):
        cells.append(f"{100 * np.median(errors):.1f} %")
    cells += [f"{100 * inside.mean():.1f} % of {len(inside)}" if len(inside) else "no intervals"]
    return [*cells, f"{seconds[peer] / seconds['exoid']:.3g}", first[1]]


def _joined(errors: FloatArray) -> str:
    return " / ".join(f"{x:.4f}" for x in errors)


def times(peers: list[str]) -> dict[str, float]:
    """Time the peers in turns, each once before, so that imports do not count.

    Args:
        peers: The peers.

    Returns:
        Best time of each [s]; a slow peer runs once.
    """
    task = swing(1)
    best: dict[str, float] = {}
    for turn in range(TURNS + 1):
        for peer in peers:
            if not turn or best[peer] < SLOW:
                taken = importlib.import_module(f"with_{peer}").identify(task, task.train).seconds
                best[peer] = min(taken, best.get(peer, np.inf)) if turn > 1 else taken
    return best


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--peers", nargs="+", choices=PEERS, default=list(PEERS))
    parser.add_argument("--seeds", type=int, default=20)
    options = parser.parse_args()
    peers = list(dict.fromkeys(["exoid", *options.peers]))
    seconds = times(peers)
    titles = ["", "lines", "swing", "DFKI", "X, J", "c, d", "coverage", "time", "friction in the export"]
    print("| " + " | ".join(titles) + " |\n" + "|---" * len(titles) + "|", flush=True)
    task = swing(1)
    assert task.truth is not None
    print(f"| the true leg | | {_joined(nrmse(task, task.truth))}" + " |" * (len(titles) - 2), flush=True)
    for peer in peers:
        print("| " + " | ".join(row(peer, options.seeds, seconds)) + " |", flush=True)


if __name__ == "__main__":
    main()
