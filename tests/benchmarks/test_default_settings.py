"""``exoid.identify`` with its default settings against a loop over Pinocchio's regressor and ``numpy.linalg.lstsq``.

``pytest tests/benchmarks/test_default_settings.py -s`` prints the ratios. The log has angles and torques of 200 000
samples. exoid derives velocities, filters, takes reversals out, weighs, models the noise and, in one of the two calls,
checks the log. The loop gets velocities and accelerations for nothing, and does none of this. The command is a process
of its own on a CSV file of seven joints, with and without checks.
"""

import os
import subprocess
import sys

import numpy as np
from arms import Arm
from long_logs import long_log
from public_robots import urdf_of
from turns import best_of_turns, looped, show

import exoid

SAMPLES, ROUNDS = 200_000, 2
WITH_CHECKS, WITHOUT = 1.4, 3.5
"""Ratios below which something has become slower; see BENCHMARKS.md for those measured."""

COMMAND = 1.6
"""Ratio that the project asks of the command with checks over that without."""

LEG = exoid.load_leg("bleex")
LOG = long_log(LEG, SAMPLES)
V, A = np.gradient(LOG.q, LOG.time, axis=0), np.gradient(np.gradient(LOG.q, LOG.time, axis=0), LOG.time, axis=0)


def loop() -> np.ndarray:
    """Pinocchio's regressor sample by sample, then the columns of the default terms, (3 N, 42)."""
    out, joints = np.zeros((SAMPLES, 3, 42)), np.arange(3)
    looped(LEG.model, (LOG.q, V, A), out[..., :30])
    for k, column in enumerate((np.tanh(V / 0.015), V, A, 1.0)):
        out[:, joints, 30 + 3 * k + joints] = column
    return out.reshape(-1, 42)


def test_identification_by_default_settings_against_the_loop_and_lstsq():
    rows, tau = loop(), LOG.tau.ravel()
    checked, bare, by_loop, solved = works = {
        "exoid.identify(leg, log)": lambda: exoid.identify(LEG, LOG),
        "exoid.identify(leg, log, check=False)": lambda: exoid.identify(LEG, LOG, check=False),
        "loop over Pinocchio's regressor, stored": loop,
        "numpy.linalg.lstsq, 42 columns": lambda: np.linalg.lstsq(rows, tau),
    }
    best = best_of_turns(works, ROUNDS)
    show(f"Identification of {SAMPLES:,} samples by default settings", best, checked)
    ratios = {ours: (best[by_loop] + best[solved]) / best[ours] for ours in (checked, bare)}
    print("  loop + lstsq: " + ", ".join(f"{ratio:.2f} × {ours}" for ours, ratio in ratios.items()))
    assert ratios[checked] >= WITH_CHECKS
    assert ratios[bare] >= WITHOUT


def test_the_command_with_checks_against_that_without(tmp_path):
    arm = Arm("panda", rate=1000.0, seconds=20.0)
    arm.recording(1, arm.noise_of(1)).to_csv(tmp_path / "arm.csv")
    out = "--output", str(tmp_path / "est.json")
    command = [sys.executable, "-m", "exoid", "--quiet", "identify", str(urdf_of("panda")), str(tmp_path / "arm.csv")]
    took = {"--check": [], "--no-check": []}
    for _ in range(2):
        for option, times in took.items():
            before = os.times()
            subprocess.run([*command, *out, option], check=True, stdout=subprocess.DEVNULL)
            after = os.times()
            times.append(after.children_user + after.children_system - before.children_user - before.children_system)
    best = {option: min(times) for option, times in took.items()}
    show("exoid identify, 20 000 samples of seven joints", best, "--no-check")
    assert best["--check"] < COMMAND * best["--no-check"]
