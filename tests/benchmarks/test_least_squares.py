"""Least squares from given q, v, a, τ, against a loop over Pinocchio's regressor and ``numpy.linalg.lstsq``.

``pytest tests/benchmarks/test_least_squares.py -s`` prints the ratios. Ours goes from samples to estimate and
covariance block by block, on orthogonal factorisations, which need no refinement. What :func:`exoid.identify` does
beyond (a model of the noise, diagnostics, a hash of the data) has no counterpart in the loop.
"""

from functools import cache

import numpy as np
from swings import harmonics
from turns import best_of_turns, looped, show, with_memory

import exoid
from exoid import Coulomb, Recording, Viscous
from exoid.identification.estimators import ols
from exoid.identification.group_rows import Group
from exoid.identification.problem import Problem
from exoid.regression.least_squares import Solution
from exoid.signals import FiniteDifference
from exoid.torques import TorqueModel

SAMPLES, RATE, ROUNDS = 200_000, 500.0, 2
RATIO, WHOLE = 5.0, 0.3
"""Below these something has become slower: the same program had 7.5 to 9.9 and 0.47 to 0.77."""
BYTES = 40.0
"""Growth of memory with each sample beyond the data."""

LEG = exoid.load_leg("bleex")
TERMS = (Coulomb(), Viscous())
MODEL = TorqueModel(LEG, TERMS)
OURS = "regressor, R factors, solution, covariance, in blocks"


@cache
def recording(samples: int = SAMPLES) -> Recording:
    """Five harmonics a joint, q, v and a without error, and torques of the model with noise."""
    rng = np.random.default_rng(0)
    omega = 2.0 * np.pi * 0.1 * np.arange(1, 6)
    amplitude, phase = rng.uniform(0.05, 0.2, (3, 5)), rng.uniform(0.0, 2.0 * np.pi, (3, 5))
    stamps = np.arange(samples) / RATE
    q, v, a = harmonics(stamps, amplitude, omega, phase)
    truth = np.append(LEG.parameters, rng.uniform(0.2, 0.8, 6))
    tau = MODEL.regressor(q, v, a) @ truth + rng.normal(scale=(1.0, 0.7, 0.3), size=q.shape)
    return Recording(stamps, q, v, a, tau, joint_names=LEG.joint_names)


def ours(samples: int = SAMPLES) -> Solution:
    """Least squares on q, v, a as they are; only the first and the last sample are dropped."""
    group = Group("", MODEL, [recording(samples)], FiniteDifference())
    return ols(Problem((group,))).solution


def whole() -> exoid.Estimate:
    """The same by the one public call, with all that it says on noise and trust."""
    return exoid.identify(LEG, recording(), TERMS, "ols", preparation=FiniteDifference(), noise="white")


def loop() -> np.ndarray:
    """Pinocchio's regressor sample by sample, with the columns of friction, (N, 3, 36)."""
    log, out, joints = recording(), np.zeros((SAMPLES, 3, 36)), np.arange(3)
    looped(LEG.model, (log.q, log.v, log.a), out[..., :30])
    out[:, joints, 30 + joints], out[:, joints, 33 + joints] = np.tanh(log.v / TERMS[0].smoothing), log.v
    return out


@cache
def standard() -> np.ndarray:
    """The rows of the samples that ours uses, (3 N, 36)."""
    return loop()[1:-1].reshape(-1, 36)


@cache
def documented() -> np.ndarray:
    """The same, reduced by hand to the 15 parameters that matter, (3 N, 15)."""
    rigid = LEG.reduction.reduce(standard()[:, :30].reshape(-1, 3, 30)).reshape(-1, 9)
    return np.hstack([rigid, standard()[:, 30:]])


def torques() -> np.ndarray:
    """What the rows should give, (3 N,)."""
    return recording().tau[1:-1].ravel()


def test_the_estimates_are_the_same():
    """Also the documented part of the shortest among the solutions for Pinocchio's standard parameters."""
    found = ours()
    reduced, *_ = np.linalg.lstsq(documented(), torques())
    np.testing.assert_allclose(found.values, reduced, rtol=1e-10, atol=1e-10)
    shortest, *_ = np.linalg.lstsq(standard(), torques())
    np.testing.assert_allclose(found.values[:9], LEG.reduction.parameters(shortest[:30]), rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(found.values[9:], shortest[30:], rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(whole().values, found.values, rtol=1e-12)


def test_least_squares_is_many_times_as_fast_as_the_loop_and_lstsq():
    works = {
        OURS: ours,
        "exoid.identify, with noise and trust": whole,
        "loop over Pinocchio's regressor, stored": loop,
        "numpy.linalg.lstsq, 36 columns": lambda: np.linalg.lstsq(standard(), torques()),
        "numpy.linalg.lstsq, 15 columns": lambda: np.linalg.lstsq(documented(), torques()),
    }
    _, identify, by_loop, wide, narrow = works
    best = best_of_turns(works, ROUNDS)
    show(f"Least squares from {SAMPLES:,} samples, three segments, 15 parameters", best, OURS)
    for name, columns in (("36 columns", wide), ("15 columns, reduced for nothing", narrow)):
        baseline = best[by_loop] + best[columns]
        print(f"  loop + lstsq, {name}: {baseline / best[OURS]:.1f} × ours, {baseline / best[identify]:.2f} × identify")
    baseline = best[by_loop] + best[narrow]
    assert baseline >= RATIO * best[OURS]
    assert baseline >= WHOLE * best[identify]


def test_least_squares_takes_no_more_memory_for_more_samples():
    peaks = {}
    for samples in (SAMPLES, 3 * SAMPLES):
        recording(samples)
        _, peaks[samples] = with_memory(lambda samples=samples: ours(samples))
    print("\n" + ", ".join(f"{memory / 1e6:.1f} MB beside {samples:,} samples" for samples, memory in peaks.items()))
    least, most = peaks.values()
    assert most - least <= BYTES * 2 * SAMPLES
    assert least <= 40e6
