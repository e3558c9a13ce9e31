"""How well does the observer read the torque of a wearer on line, and does it raise alarms where nobody is?

    python scripts/study_observer.py --seed 100  # many minutes; --runs 4 --minutes 2 is quicker

Virtual rigs with friction that sticks, encoders of 2^16 counts a turn, and torque noise of 0.5, 0.4 and 0.2 N·m, logged
at 1 kHz. The model is identified from an unworn log of 30 s. Wearers are active, who walk while the actuators are off,
or passive, limbs that a stiff servo moves, in strides of 1.2 to 2.4 s. NRMSE is the RMS difference between
reading and true torque at the same time, over the standard deviation of the truth, the largest of all wearers.
"Aligned" is the same with the delay taken out. Unworn rigs move and rest in turn. The last table delays the velocities
only, or all channels alike.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

import exoid
from exoid import Leg
from exoid.control import MomentumObserver, SensorNoise

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from observing import WornLog, estimate_of, nrmse, passive_run, slow_tachometer, sticking_run, worn_run

RATE = 1000.0
STRIDES = 1.2, 2.4
"""Shortest and longest stride time [s]."""

BANDWIDTH = 25.0
"""Bandwidth for wearers [Hz]: a delay of 13 to 15 ms."""

CALM = 20.0
"""Bandwidth where nobody walks [Hz]."""

HELD = 0.5 / RATE
"""The rig logs the torque of the interval before each sample: it is half a sample late."""


def observer_of(leg: Leg, noise: SensorNoise, bandwidth: float) -> MomentumObserver:
    """Observer with the model of an estimate."""
    return MomentumObserver(estimate_of(leg, zero=0.0), bandwidth, RATE, noise=noise, torque_delay=HELD)


def worn(leg: Leg, kind: str, runs: int, seed: int) -> None:
    """Print the errors of readings of worn rigs."""
    rigs = {"active": worn_run, "passive": passive_run}[kind]
    periods = np.linspace(*STRIDES, runs)
    run = rigs(leg, periods, 8.0, seed)
    observer = observer_of(leg, SensorNoise.of(run.recording(0)), BANDWIDTH)
    found, late = [], np.full(len(observer.names), round(observer.delay * RATE))
    for k in range(runs):
        truth, read = run.interaction[..., k], observer.run(run.recording(k)).torque
        aligned = [float(nrmse(x[d:], y[: len(y) - d], 1000)) for x, y, d in zip(read.T, truth.T, late, strict=True)]
        sizes = truth[1000:].std(axis=0), np.sqrt(((read - truth)[1000:] ** 2).mean(axis=0))
        found.append((nrmse(read, truth, 1000), aligned, *sizes))
    error, aligned, size, left = np.swapaxes(np.array(found), 0, 1)
    worst = error.argmax(axis=0), np.arange(error.shape[1])
    print(
        f"{leg.description.name:12} {kind:8} {len(found):2} wearers   "
        f"delay {1e3 * observer.delay:.1f} ms   NRMSE {error.max(axis=0).round(3)}   "
        f"median {np.median(error, axis=0).round(3)}   aligned {aligned.max(axis=0).round(3)}   "
        f"error where largest {left[worst].round(3)} of {size[worst].round(2)} N·m",
        flush=True,
    )


def unworn(leg: Leg, minutes: float, seed: int) -> None:
    """Print alarms of unworn rigs, and how near readings came to them."""
    rigs = max(1, round(3.0 * minutes))
    run = sticking_run(leg, rigs, 20.5, seed)
    observer = observer_of(leg, SensorNoise.of(run.recording(0)), CALM)
    for stiction in (1.2, 0.0):
        tried = replace(observer, stiction=stiction)
        alarms, largest = np.zeros((2, len(leg.joint_names)))
        for k in range(rigs):
            found = tried.run(run.recording(k))
            alarms += found.alarms
            over = (np.abs(found.torque) - found.stiction) / found.std
            largest = np.maximum(largest, over[found.settling :].max(axis=0))
        print(
            f"{leg.description.name:12} stiction {stiction:3.1f}   "
            f"alarms {alarms.astype(int)}   largest {largest.round(2)} std of {tried.threshold.min():.2f}"
        )


def delays(leg: Leg) -> None:
    """Print the errors where only the velocity is filtered."""
    log = WornLog(leg, seed=2)
    recording, lag = slow_tachometer(log, 5.0)
    estimate = estimate_of(leg)
    for title, told in (("velocity only", 0.0), ("all channels", lag)):
        observer = MomentumObserver(estimate, 10.0, RATE, cutoff=np.inf, noise=log.sensors, velocity_delay=told)
        read = observer.run(recording)
        error = nrmse(read.torque, log.wearer, read.settling)
        print(f"{leg.description.name:12} {title:14} delay {1e3 * observer.delay:5.1f} ms   NRMSE {error.round(3)}")


def main() -> None:
    """Read the options and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=16)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    legs = [exoid.load_leg(name) for name in ("bleex", "cuhk")]
    print(f"worn, strides of {STRIDES[0]:g} to {STRIDES[1]:g} s")
    for leg in legs:
        for kind in ("active", "passive"):
            worn(leg, kind, options.runs, options.seed)
    print(f"\nunworn, {options.minutes:g} min, 1e-3 false alarms a minute asked for", flush=True)
    for leg in legs:
        unworn(leg, options.minutes, options.seed)
    print("\nvelocities with a low-pass of 5 Hz")
    for leg in legs:
        delays(leg)


if __name__ == "__main__":
    main()
