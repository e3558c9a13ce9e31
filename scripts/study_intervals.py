"""How often do 95 % intervals contain the truth, and how far is each estimator from the Cramér–Rao bound?

A three-segment leg (BLEEX, CAD inertias), five harmonics of 0.1 Hz, 20 s at 500 Hz. 15 parameters: X, Y, J of each
segment, Coulomb and viscous friction.

Torque noise of 1.0, 0.7 and 0.3 N·m (hip, knee, ankle) is of one of these kinds:

* white, AR(1) with a time constant of 50 ms, or mix: 80 % of the variance AR(1) and 20 % white;
* speed2: white, its size proportional to the square of the joint's velocity;
* speed: AR(1) of 0.2 s, its size proportional to the joint's speed;
* gain: white, and a gain of each torque sensor that wanders by 3 % (AR(1) of 1 s);
* force: white, and a force of 10 N at the foot that all joints feel (AR(1) of 50 ms);
* common: the same AR(1) of 50 ms at all joints.

Rows are exact (velocities and accelerations are recorded, no filter), zero-phase (the same, behind the parallel
filter), or angles-S: only angles with white noise of S rad are recorded. Coulomb friction is sharp with the first two
and tanh(v / 0.02) with the last.

    OMP_NUM_THREADS=1 python scripts/study_intervals.py        # 40 replicates of wls
    OMP_NUM_THREADS=1 EXOID_FULL_STUDIES=1 python scripts/study_intervals.py    # 400 replicates of four estimators
    OMP_NUM_THREADS=1 python scripts/study_intervals.py --estimators wls,ml --rows angles-0,angles-1e-4,angles-1e-3
"""

from __future__ import annotations

import argparse
import itertools
import math
import os
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import cache, partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_banded
from scipy.signal import lfilter

import exoid
from exoid._typing import FloatArray
from exoid.signals import FiniteDifference, ZeroPhase
from exoid.torques import TorqueModel

RATE, SECONDS = 500.0, 20.0
NOISE = np.array([1.0, 0.7, 0.3])
MEMORY = math.exp(-1.0 / (0.05 * RATE))
COLOURED = {"white": 0.0, "AR(1)": 1.0, "mix": 0.8}
"""Share of the variance that is AR(1)."""
KINDS = (*COLOURED, "speed2", "speed", "gain", "force", "common")
GAIN, FORCE, FOOT = 0.03, 10.0, 0.1
"""Standard deviation of a gain that wanders, and of a force [N] on the foot, so far below the ankle [m]."""
PREPARATIONS = {"exact": FiniteDifference(), "zero-phase": ZeroPhase()}
SHARP = (exoid.Coulomb(smoothing=0.0, reversal_speed=0.0), exoid.Viscous())
SMOOTH = (exoid.Coulomb(smoothing=0.02, reversal_speed=0.0), exoid.Viscous())
FRICTION = np.array([0.8, 0.6, 0.4, 0.5, 0.3, 0.2])
FULL = os.environ.get("EXOID_FULL_STUDIES") == "1"


Names = Sequence[str]


class Swing(NamedTuple):
    """The leg, its true parameters, and a motion without noise."""

    leg: exoid.Leg
    terms: tuple[exoid.Term, ...]
    truth: FloatArray
    stamps: FloatArray
    motion: tuple[FloatArray, FloatArray, FloatArray]
    tau: FloatArray


class Outcome(NamedTuple):
    """Errors of one estimate, which of its 95 % intervals contain the truth, and its standard deviations."""

    errors: FloatArray
    inside: NDArray[np.bool_]
    std: FloatArray


@cache
def swing(terms: tuple[exoid.Term, ...] = SHARP) -> Swing:
    """Make the leg, move it, and compute the exact torque."""
    leg = exoid.load_leg("bleex", inertias="cad")
    rng = np.random.default_rng(1)
    omega = 2.0 * np.pi * 0.1 * np.arange(1, 6)
    amplitude = 0.42 * rng.uniform(0.4, 1.0, (3, 5)) / np.array([1.0, 1.2, 1.5, 2.0, 2.5])
    phase = rng.uniform(0.0, 2.0 * np.pi, (3, 5))
    stamps = np.arange(int(SECONDS * RATE)) / RATE
    argument = np.multiply.outer(stamps, omega)[:, None, :] + phase
    q = (amplitude * np.sin(argument)).sum(-1)
    v = (amplitude * omega * np.cos(argument)).sum(-1)
    a = -(amplitude * omega**2 * np.sin(argument)).sum(-1)
    truth = np.concatenate([leg.parameters, FRICTION])
    tau = TorqueModel(leg, terms).regressor(q, v, a) @ truth
    return Swing(leg, terms, truth, stamps, (q, v, a), tau)


def red(rng: np.random.Generator, shape: tuple[int, ...], memory: float = MEMORY) -> FloatArray:
    """Draw stationary AR(1) noise of unit variance."""
    drive = rng.standard_normal(shape) * math.sqrt(1.0 - memory**2)
    drive[0] /= math.sqrt(1.0 - memory**2)
    return np.asarray(lfilter([1.0], [1.0, -memory], drive, axis=0))


def noise(rng: np.random.Generator, kind: str, motion: Swing) -> FloatArray:
    """Draw torque noise of a kind [N·m], (N, n)."""
    tau, v = motion.tau, motion.motion[1]
    if kind in COLOURED:
        share, white = COLOURED[kind], rng.standard_normal(tau.shape)
        return NOISE * (math.sqrt(share) * red(rng, tau.shape) + math.sqrt(1.0 - share) * white)
    if kind == "speed2":
        return NOISE * v**2 / (v**2).mean(axis=0) * rng.standard_normal(tau.shape)
    if kind == "speed":
        size = np.abs(v) / np.sqrt((v**2).mean(axis=0))
        return np.asarray(NOISE * size * red(rng, tau.shape, math.exp(-1.0 / (0.2 * RATE))))
    if kind == "common":
        return NOISE * red(rng, (len(tau), 1))
    white = NOISE * rng.standard_normal(tau.shape)
    if kind == "gain":
        return white + GAIN * red(rng, tau.shape, math.exp(-1.0 / RATE)) * tau
    return white + FORCE * red(rng, (len(tau), 1)) * levers(motion)


def levers(motion: Swing) -> FloatArray:
    """Torque of a horizontal force of 1 N on the foot at each joint [m], (N, n)."""
    assert motion.leg.chain is not None
    lengths = np.append(np.linalg.norm(motion.leg.chain.offsets, axis=1), FOOT)
    heights = lengths * np.cos(np.cumsum(motion.motion[0], axis=1))
    return np.asarray(np.cumsum(heights[:, ::-1], axis=1)[:, ::-1])


def replicate(seed: int, kind: str, rows: str, estimator: str, assumed: str = "correlated") -> Outcome:
    """Identify once."""
    only_angles, _, size = rows.partition("-") if rows.startswith("angles-") else ("", "", "0")
    moved = swing(SMOOTH if only_angles else SHARP)
    rng = np.random.default_rng([seed, KINDS.index(kind)])
    measured = moved.tau + noise(rng, kind, moved)
    q, v, a = moved.motion
    if only_angles:
        angles = q + float(size) * rng.standard_normal(q.shape)
        recording = exoid.Recording(moved.stamps, angles, tau=measured, joint_names=moved.leg.joint_names)
    else:
        recording = exoid.Recording(moved.stamps, q, v=v, a=a, tau=measured, joint_names=moved.leg.joint_names)
    estimate = exoid.identify(
        moved.leg, recording, moved.terms, estimator, preparation=PREPARATIONS.get(rows), noise=assumed
    )
    low, high = estimate.interval().T
    return Outcome(estimate.values - moved.truth, (low <= moved.truth) & (moved.truth <= high), estimate.std)


def cramer_rao(kind: str) -> FloatArray:
    """Return the smallest variances that an unbiased estimate can have: diagonal of (Σ_j W_jᵀ Γ_j⁻¹ W_j)⁻¹, (P,).

    NaN for noise that is not stationary, or not independent between joints.

    With Q the inverse, tridiagonal, of the covariance of AR(1) noise of unit variance and s its share,
    Γ⁻¹ = (s Q⁻¹ + (1 − s) I)⁻¹ = (s I + (1 − s) Q)⁻¹ Q.
    """
    if kind not in COLOURED:
        return np.full(len(swing().truth), np.nan)
    leg, terms, _, stamps, motion, _ = swing()
    W = TorqueModel(leg, terms).regressor(*motion)
    share, diagonal = COLOURED[kind], np.full(len(stamps), 1.0 + MEMORY**2)
    diagonal[[0, -1]] = 1.0
    Q = np.vstack([np.full(len(stamps), -MEMORY), diagonal, np.full(len(stamps), -MEMORY)]) / (1.0 - MEMORY**2)
    inner = (1.0 - share) * Q
    inner[1] += share
    information = np.zeros((W.shape[-1],) * 2)
    for j, std in enumerate(NOISE):
        QW = Q[1][:, None] * W[:, j]
        QW[1:] += Q[0][0] * W[:-1, j]
        QW[:-1] += Q[0][0] * W[1:, j]
        information += W[:, j].T @ solve_banded((1, 1), inner, QW) / std**2
    return np.diag(np.linalg.inv(information))


def study(replicates: int, estimators: Names, rows: Names, kinds: Names, workers: int) -> None:
    """Print a line for each combination."""
    columns = ("coverage", "worst", "MSE/CRB", "worst", "std/true", "s each")
    print(f"{'rows':13}{'noise':8}{'estimator':12}" + "".join(f"{c:>9}" for c in columns) + "  worst parameter")
    names = TorqueModel(swing().leg, SHARP).names
    with ProcessPoolExecutor(workers) as pool:
        for prepared, kind, estimator in itertools.product(rows, kinds, estimators):
            name, _, naive = estimator.partition("-")
            assumed = "white" if naive else "correlated"
            run = partial(replicate, kind=kind, rows=prepared, estimator=name, assumed=assumed)
            start = time.perf_counter()
            results = list(pool.map(run, range(replicates), chunksize=5))
            each = (time.perf_counter() - start) * workers / replicates
            errors, inside, std = (np.array(x) for x in zip(*results, strict=True))
            cover, mse = inside.mean(axis=0), (errors**2).mean(axis=0)
            ratio, size = mse / cramer_rao(kind), np.sqrt((std**2).mean(axis=0) / mse)
            print(
                f"{prepared:13}{kind:8}{estimator:12}{100 * cover.mean():8.1f}%{100 * cover.min():8.1f}%"
                f"{ratio.mean():9.2f}{ratio.max():9.2f}{size.mean():9.3f}{each:9.3f}  {names[int(cover.argmin())]}",
                flush=True,
            )


def main() -> None:
    """Read options and run."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--replicates", type=int, default=400 if FULL else 40)
    names = "wls,huber,wls-naive" if FULL else "wls"
    parser.add_argument("--estimators", default=names, help="also ml; wls-naive assumes white noise")
    parser.add_argument("--rows", default="exact,zero-phase", help="also angles-0, angles-1e-4, angles-1e-3 [rad]")
    parser.add_argument("--noise", default=",".join(KINDS))
    parser.add_argument("--workers", type=int, default=2)
    given = parser.parse_args()
    study(given.replicates, given.estimators.split(","), given.rows.split(","), given.noise.split(","), given.workers)


if __name__ == "__main__":
    main()
