"""What do the ends of a short log cost, and do intervals hold that come from swing phases of 0.4 s?

    python scripts/study_short_logs.py              # both tables; the second takes some minutes on one core
    python scripts/study_short_logs.py --loss       # only the first

The first table has the seconds that each end of a log loses, with angles continued by point reflection until exoid 0.1
and by polynomials since, and the worst error of a parameter that is identified from noise-free angles of 6 s.

The second has the coverage of 95 % intervals from 30 swing phases of 0.4 s at 100 Hz, once a second. Torque noise is
white, or AR(1) with a time constant of 50 ms, of 0.3, 0.2 and 0.1 N·m. The phases are segments of one log, in which the
torque between them is not that of a free leg, or recordings of their own. The leg is BLEEX with CAD inertias; five
harmonics of 0.45 Hz; 15 parameters.
"""

from __future__ import annotations

import argparse
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

import exoid
from exoid._typing import FloatArray
from exoid.signals import ZeroPhase
from exoid.signals.filters.low_pass import edge_length

TERMS = (exoid.Coulomb(smoothing=0.02, reversal_speed=0.0), exoid.Viscous())
FRICTION = np.array([0.8, 0.6, 0.4, 0.5, 0.3, 0.2])
SMOOTHING = 0.02
NOISE = np.array([0.3, 0.2, 0.1])
RATE, SWINGS, LENGTH = 100.0, 30, 0.4
KINDS = {"white": 0.0, "AR(1)": 0.05}
"""Time constant of the torque noise [s]."""


class Log(NamedTuple):
    """A noise-free log, and the true parameters."""

    leg: exoid.Leg
    truth: FloatArray
    recording: exoid.Recording


def make_log(seed: int, rate: float, seconds: float, base: float) -> Log:
    """Move the leg by five harmonics that begin in the middle of a motion."""
    leg = exoid.load_leg("bleex", inertias="cad")
    rng = np.random.default_rng(seed)
    t = 2.137 + np.arange(round(seconds * rate)) / rate
    omega = 2.0 * np.pi * base * np.arange(1, 6)
    amplitude = 0.42 * rng.uniform(0.4, 1.0, (3, 5)) / np.array([1.0, 1.2, 1.5, 2.0, 2.5])
    argument = np.multiply.outer(t, omega)[:, None, :] + rng.uniform(0.0, 2.0 * np.pi, (3, 5))
    q = (amplitude * np.sin(argument)).sum(-1)
    v = (amplitude * omega * np.cos(argument)).sum(-1)
    a = -(amplitude * omega**2 * np.sin(argument)).sum(-1)
    tau = leg.inverse_dynamics(q, v, a) + FRICTION[:3] * np.tanh(v / SMOOTHING) + FRICTION[3:] * v
    return Log(
        leg, np.concatenate([leg.parameters, FRICTION]), exoid.Recording(t, q, tau=tau, joint_names=leg.joint_names)
    )


def old_edge(cutoff: float, rate: float) -> float:
    """Seconds that each end lost to both filters when motions were continued by point reflection."""
    return (edge_length(rate, 2.0 * cutoff) + edge_length(rate, cutoff)) / rate


def print_loss() -> None:
    """Print the first table."""
    print(f"{'cut-off [Hz]':>12}{'rate [Hz]':>11}{'lost before [s]':>17}{'lost now [s]':>14}{'worst error':>13}")
    for cutoff in (3.0, 5.0, 8.0):
        for rate in (100.0, 500.0):
            errors = []
            for seed in range(5):
                log = make_log(seed, rate, 6.0, 0.3)
                estimate = exoid.identify(log.leg, log.recording, TERMS, cutoff=cutoff)
                errors.append(np.abs(estimate.values / log.truth - 1.0).max())
            now = ZeroPhase(cutoff).edge(rate) / rate
            print(f"{cutoff:12g}{rate:11g}{old_edge(cutoff, rate):17.3f}{now:14.3f}{max(errors):13.1e}")


def coloured(rng: np.random.Generator, time_constant: float, shape: tuple[int, ...]) -> FloatArray:
    """Draw stationary noise of unit variance."""
    memory = math.exp(-1.0 / (time_constant * RATE)) if time_constant else 0.0
    drive = rng.standard_normal(shape)
    drive[1:] *= math.sqrt(1.0 - memory**2)
    return np.asarray(lfilter([1.0], [1.0, -memory], drive, axis=0))


def replicate(seed: int, time_constant: float, *, segments: bool) -> tuple[NDArray[np.bool_], FloatArray, int]:
    """Identify from 30 swing phases: which intervals hold, errors over standard deviations, and warnings."""
    log = make_log(seed, RATE, SWINGS + 1.0, 0.45)
    rng, recording = np.random.default_rng([seed, 1]), log.recording
    tau = recording.tau + NOISE * coloured(rng, time_constant, recording.tau.shape)
    starts = [round((0.3 + k) * RATE) for k in range(SWINGS)]
    spans = [(start, start + round(LENGTH * RATE)) for start in starts]
    inside = np.zeros((len(tau), 1), dtype=bool)
    for first, last in spans:
        inside[first:last] = True
    whole = exoid.Recording(
        recording.time,
        recording.q,
        tau=np.where(inside, tau, tau + 30.0 * rng.standard_normal(tau.shape)),
        joint_names=recording.joint_names,
        mask=inside[:, 0],
    )
    alone = [exoid.Recording(*_cut(recording, tau, *span), joint_names=recording.joint_names) for span in spans]
    estimate = exoid.identify(log.leg, whole if segments else alone, TERMS)
    low, high = estimate.interval().T
    short = sum("too short" in warning for warning in estimate.warnings)
    return (low <= log.truth) & (log.truth <= high), (estimate.values - log.truth) / estimate.std, short


def _cut(
    recording: exoid.Recording, tau: FloatArray, first: int, last: int
) -> tuple[FloatArray, FloatArray, None, None, FloatArray]:
    return recording.time[first:last], recording.q[first:last], None, None, tau[first:last]


def print_coverage(replicates: int) -> None:
    """Print the second table."""
    print(f"{'swings are':12}{'noise':8}{'coverage':>10}{'worst':>8}{'error/std':>11}{'warned':>8}")
    for segments in (True, False):
        for kind, time_constant in KINDS.items():
            found = [replicate(seed, time_constant, segments=segments) for seed in range(replicates)]
            inside, errors, warned = (np.array(part) for part in zip(*found, strict=True))
            ratio = np.median(np.sqrt((errors**2).mean(axis=0)))
            name = "segments" if segments else "recordings"
            print(
                f"{name:12}{kind:8}{inside.mean():10.3f}{inside.mean(axis=0).min():8.2f}{ratio:11.2f}{warned.mean():8.0%}"
            )


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--loss", action="store_true", help="print only what the ends cost")
    parser.add_argument("--replicates", type=int, default=40)
    arguments = parser.parse_args()
    print_loss()
    if not arguments.loss:
        print()
        print_coverage(arguments.replicates)


if __name__ == "__main__":
    main()
