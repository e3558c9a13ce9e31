"""How often do 95 % intervals contain the truth, and how far is each estimator from the Cramér–Rao bound?

A three-segment leg (BLEEX, CAD inertias), five harmonics of 0.1 Hz, 20 s at 500 Hz, exact angles, velocities and
accelerations, torque noise of 1.0, 0.7 and 0.3 N·m (hip, knee, ankle): white, AR(1) with a time constant of 50 ms, or
80 % of its variance AR(1) and 20 % white. 15 parameters: X, Y, J of each segment, Coulomb and viscous friction.

    OMP_NUM_THREADS=1 python scripts/study_intervals.py        # the whole study: about 20 minutes on two cores
    OMP_NUM_THREADS=1 python scripts/study_intervals.py --replicates 40 --estimators wls
"""

from __future__ import annotations

import argparse
import itertools
import math
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
PREPARATIONS = {"exact": FiniteDifference(), "zero-phase": ZeroPhase()}
TERMS = (exoid.Coulomb(smoothing=0.0), exoid.Viscous())
FRICTION = np.array([0.8, 0.6, 0.4, 0.5, 0.3, 0.2])


Names = Sequence[str]


class Swing(NamedTuple):
    """The leg, its true parameters, and a motion without noise."""

    leg: exoid.Leg
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
def swing() -> Swing:
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
    tau = TorqueModel(leg, TERMS).regressor(q, v, a) @ truth
    return Swing(leg, truth, stamps, (q, v, a), tau)


def noise(rng: np.random.Generator, coloured: float, shape: tuple[int, ...]) -> FloatArray:
    """Draw stationary noise of unit variance, ``coloured`` of it AR(1)."""
    white = rng.standard_normal(shape)
    drive = rng.standard_normal(shape) * math.sqrt(1.0 - MEMORY**2)
    drive[0] /= math.sqrt(1.0 - MEMORY**2)
    return math.sqrt(coloured) * lfilter([1.0], [1.0, -MEMORY], drive, axis=0) + math.sqrt(1.0 - coloured) * white


def replicate(seed: int, kind: str, preparation: str, estimator: str, prior_knowledge: str = "correlated") -> Outcome:
    """Identify once."""
    leg, truth, stamps, (q, v, a), tau = swing()
    rng = np.random.default_rng([seed, list(COLOURED).index(kind)])
    measured = tau + NOISE * noise(rng, COLOURED[kind], tau.shape)
    recording = exoid.Recording(stamps, q, v=v, a=a, tau=measured, joint_names=leg.joint_names)
    estimate = exoid.identify(
        leg, recording, TERMS, estimator, preparation=PREPARATIONS[preparation], noise=prior_knowledge
    )
    low, high = estimate.interval().T
    return Outcome(estimate.values - truth, (low <= truth) & (truth <= high), estimate.std)


def cramer_rao(kind: str) -> FloatArray:
    """Return the smallest variances that an unbiased estimate can have: diagonal of (Σ_j W_jᵀ Γ_j⁻¹ W_j)⁻¹, (P,).

    With Q the inverse, tridiagonal, of the covariance of AR(1) noise of unit variance and s its share,
    Γ⁻¹ = (s Q⁻¹ + (1 − s) I)⁻¹ = (s I + (1 − s) Q)⁻¹ Q.
    """
    leg, _, stamps, motion, _ = swing()
    W = TorqueModel(leg, TERMS).regressor(*motion)
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


def study(replicates: int, estimators: Names, preparations: Names, kinds: Names, workers: int) -> None:
    """Print a line for each combination."""
    columns = ("coverage", "worst", "MSE/CRB", "worst", "std/true", "s each")
    print(f"{'rows':11}{'noise':7}{'estimator':15}" + "".join(f"{column:>9}" for column in columns))
    bounds = {kind: cramer_rao(kind) for kind in kinds}
    with ProcessPoolExecutor(workers) as pool:
        for preparation, kind, estimator in itertools.product(preparations, kinds, estimators):
            name, _, naive = estimator.partition("-")
            run = partial(
                replicate,
                kind=kind,
                preparation=preparation,
                estimator=name,
                prior_knowledge="white" if naive else "correlated",
            )
            start = time.perf_counter()
            results = list(pool.map(run, range(replicates), chunksize=5))
            each = (time.perf_counter() - start) * workers / replicates
            errors, inside, std = (np.array(x) for x in zip(*results, strict=True))
            cover, mse = inside.mean(axis=0), (errors**2).mean(axis=0)
            ratio, size = mse / bounds[kind], np.sqrt((std**2).mean(axis=0) / mse)
            print(
                f"{preparation:11}{kind:7}{estimator:15}{100 * cover.mean():8.1f}%{100 * cover.min():8.1f}%"
                f"{ratio.mean():9.2f}{ratio.max():9.2f}{size.mean():9.3f}{each:9.3f}",
                flush=True,
            )


def main() -> None:
    """Read options and run."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--replicates", type=int, default=400)
    parser.add_argument("--estimators", default="wls,gls,huber,wls-naive", help="wls-naive assumes white noise")
    parser.add_argument("--rows", default="exact,zero-phase")
    parser.add_argument("--noise", default="white,AR(1),mix")
    parser.add_argument("--workers", type=int, default=2)
    given = parser.parse_args()
    study(given.replicates, given.estimators.split(","), given.rows.split(","), given.noise.split(","), given.workers)


if __name__ == "__main__":
    main()
