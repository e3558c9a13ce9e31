"""How well do observers read the torque of a wearer on line, and do they raise alarms where nobody is?

    python scripts/study_observer.py             # five minutes on one core; --runs 4 --minutes 2 is quicker

Virtual rigs with friction that sticks, encoders of 2^16 counts a turn, and torque noise of 0.5, 0.4 and 0.2 N·m, logged
at 1 kHz. The model is identified from an unworn log of 30 s. Wearers walk while the actuators are off. NRMSE is the RMS
difference between reading and true torque at the same time, over the standard deviation of the truth, the largest of
all wearers. "Aligned" is the same with the delay taken out. Unworn rigs move and rest in turn. The last table delays
the velocities only, or all channels alike.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

import exoid
from exoid import Leg
from exoid.control import KalmanObserver, MomentumObserver, SensorNoise
from exoid.control.observers import TorqueObserver

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from observing import WornLog, estimate_of, nrmse, slow_tachometer, sticking_run, worn_run

RATE = 1000.0
WALKS = ((1.0, 1.4, (36.0, 45.0)), (1.6, 3.0, (22.0, 32.0)))
"""Shortest and longest stride time [s], and bandwidth of the observers of each leg [Hz]."""

BANDWIDTH = 20.0
"""Bandwidth where nobody walks [Hz]."""

HELD = 0.5 / RATE
"""The rig logs the torque of the interval before each sample: it is half a sample late."""


def observers(leg: Leg, noise: SensorNoise, bandwidth: float) -> list[TorqueObserver]:
    """Both observers with the model of an estimate."""
    estimate = estimate_of(leg, zero=0.0)
    return [
        MomentumObserver(estimate, bandwidth, RATE, noise=noise, torque_delay=HELD),
        KalmanObserver(estimate, bandwidth, RATE, noise=noise, torque_delay=HELD),
    ]


def worn(leg: Leg, runs: int, shortest: float, longest: float, bandwidth: float) -> None:
    """Print the errors of readings of worn rigs."""
    run = worn_run(leg, np.linspace(shortest, longest, runs), 8.0)
    for observer in observers(leg, SensorNoise.of(run.recording(0)), bandwidth):
        late = round(float(observer.delay.max()) * RATE)
        found = [observer.run(run.recording(k)).torque for k in range(runs)]
        errors = [nrmse(read, run.interaction[..., k], 1000) for k, read in enumerate(found)]
        aligned = [nrmse(read[late:], run.interaction[:-late, :, k], 1000) for k, read in enumerate(found)]
        print(
            f"{leg.description.name:12} {type(observer).__name__:17} {bandwidth:g} Hz   "
            f"delay {1e3 * observer.delay.max():5.1f} ms   "
            f"NRMSE {np.max(errors, axis=0).round(3)}   aligned {np.max(aligned, axis=0).round(3)}"
        )


def unworn(leg: Leg, minutes: float) -> None:
    """Print alarms of unworn rigs, and how near readings came to them."""
    rigs = round(3.0 * minutes)
    run = sticking_run(leg, rigs, 20.5)
    for observer in observers(leg, SensorNoise.of(run.recording(0)), BANDWIDTH):
        for stiction in (1.2, 0.0):
            tried = type(observer)(
                observer.source, BANDWIDTH, RATE, noise=observer.noise, torque_delay=HELD, stiction=stiction
            )
            alarms, largest = np.zeros((2, len(leg.joint_names)))
            for k in range(rigs):
                found = tried.run(run.recording(k))
                alarms += found.alarms
                over = (np.abs(found.torque) - found.stiction) / found.std
                largest = np.maximum(largest, over[found.settling :].max(axis=0))
            print(
                f"{leg.description.name:12} {type(observer).__name__:17} stiction {stiction:3.1f}   "
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
        print(
            f"{leg.description.name:12} {title:14} delay {1e3 * observer.delay.max():5.1f} ms   NRMSE {error.round(3)}"
        )


def main() -> None:
    """Read the options and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=16)
    parser.add_argument("--minutes", type=float, default=10.0)
    options = parser.parse_args()
    legs = [exoid.load_leg(name) for name in ("bleex", "cuhk")]
    for shortest, longest, bandwidths in WALKS:
        print(f"worn, strides of {shortest:g} to {longest:g} s")
        for leg, bandwidth in zip(legs, bandwidths, strict=True):
            worn(leg, options.runs, shortest, longest, bandwidth)
    print(f"\nunworn, {options.minutes:g} min, 1e-3 false alarms a minute asked for")
    for leg in legs:
        unworn(leg, options.minutes)
    print("\nvelocities with a low-pass of 5 Hz")
    for leg in legs:
        delays(leg)


if __name__ == "__main__":
    main()
