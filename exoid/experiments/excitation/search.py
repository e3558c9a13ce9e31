"""Search for the best motion from several starts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .fourier import FourierMotion, States
from .objective import EXCESSES, Objective, Stage

FINER = 10
"""Refinement of the time grid of the search for the check of the limits."""

SHRINK = 0.998
"""Factor by which a motion is scaled about its centre, again and again, until it is within the limits."""

SMALLEST = 0.5
"""Smallest total factor; a motion that needs a smaller one is rejected."""

MARGIN = 0.004
"""Fraction of each limit that the search reserves for values between its samples."""

GAP = 0.003
"""Additional clearance of the foot in the search [m]."""

FIRST = {"worst": Stage(1.0, 30.0), "a": Stage(1.0, 30.0), "d": Stage(0.0, 30.0)}
"""First stage of each criterion, with a low penalty; all starts pass through it."""

LAST = {
    "worst": (Stage(4.0, 300.0), Stage(16.0, 3e3), Stage(40.0, 3e4)),
    "a": (Stage(1.0, 3e3), Stage(1.0, 3e4)),
    "d": (Stage(0.0, 3e3), Stage(0.0, 3e4)),
}
"""Later stages of each criterion, for the better half of the starts."""

ITERATIONS = 60
"""Largest number of iterations of each stage but the last."""

LAST_ITERATIONS = 150
"""Largest number of iterations of the last stage."""


class Iterate(NamedTuple):
    """Point of the search: motions after some stages.

    Attributes:
        cost: Value of the objective.
        x: Coefficients of the motions, (T, m, n).
    """

    cost: float
    x: FloatArray


class SearchResult(NamedTuple):
    """Result of a search.

    Attributes:
        motions: Best motion at each torso tilt.
        costs: Value of the objective without penalty, for all starts that passed all stages, the best first.
    """

    motions: tuple[FourierMotion, ...]
    costs: tuple[float, ...]


def search(
    objective: Objective,
    criterion: str,
    starts: int,
    seed: int | np.random.Generator,
    progress: Callable[[float], None] | None = None,
) -> SearchResult:
    """Draw motions, optimise all in a first stage and the better half in all stages, and keep the best.

    Args:
        objective: Objective to minimise.
        criterion: "worst", "a" or "d".
        starts: Number of motions drawn.
        seed: Seed or generator of the draws.
        progress: Function that receives the completed share, 0 to 1.

    Returns:
        Best motions, and costs of all that were finished.

    Raises:
        ExoidError: No motion was found within the limits.
    """
    report, last = progress or (lambda _: None), LAST[criterion]
    inner = _narrowed(objective)
    better = max(1, (starts + 1) // 2)
    total, done = starts + better * (len(last) + 1.5), 0.0
    drawn: list[Iterate] = []
    for generator in np.random.default_rng(seed).spawn(starts):
        drawn.append(_minimise(inner, _draw(objective, generator), FIRST[criterion], ITERATIONS))
        done += 1.0
        report(done / total)
    drawn.sort(key=lambda iterate: iterate.cost)
    finished: list[Iterate] = []
    for number, iterate in enumerate(drawn):
        if number >= better and finished:
            break
        for stage in last:
            final = stage is last[-1]
            iterate = _minimise(inner, iterate.x, stage, LAST_ITERATIONS if final else ITERATIONS)  # noqa: PLW2901
            done += 2.5 if final else 1.0
            report(min(done / total, 1.0))
        x = _within_limits(objective, iterate.x)
        if x is not None:
            finished.append(Iterate(objective(x.ravel(), Stage(last[-1].power, 0.0))[0], x))
    if not finished:
        raise _no_motion(objective, iterate.x)
    finished.sort(key=lambda iterate: iterate.cost)
    motions = zip(finished[0].x, objective.pitches, strict=True)
    return SearchResult(
        tuple(objective.basis.motion(x, objective.seconds, float(pitch)) for x, pitch in motions),
        tuple(iterate.cost for iterate in finished),
    )


def _minimise(objective: Objective, x: FloatArray, stage: Stage, iterations: int) -> Iterate:
    """Minimise by L-BFGS."""
    result = scipy.optimize.minimize(
        objective, x.ravel(), args=(stage,), jac=True, method="L-BFGS-B", options={"maxiter": iterations, "maxcor": 20}
    )
    return Iterate(float(result.fun), np.asarray(result.x).reshape(objective.shape))


def _draw(objective: Objective, rng: np.random.Generator) -> FloatArray:
    """Draw coefficients, and scale those of each joint to 50 to 95 % of its limits."""
    limits, basis = objective.limits, objective.basis
    x = rng.standard_normal(objective.shape)
    for each in x:
        q, v, a = (part[:, 1:] @ each[1:] for part in (basis.position, basis.velocity, basis.acceleration))
        factors = np.array(
            [
                limits.span / np.ptp(q, axis=0),
                limits.velocity / np.abs(v).max(axis=0),
                limits.acceleration / np.abs(a).max(axis=0),
            ]
        )
        scale = rng.uniform(0.5, 0.95) * factors.min(axis=0)
        each[1:] *= scale
        middle = 0.5 * scale * (q.max(axis=0) + q.min(axis=0))
        left = limits.span - scale * np.ptp(q, axis=0)
        each[0] = 0.5 * (limits.lower + limits.upper) - middle + 0.3 * left * rng.uniform(-1.0, 1.0, left.shape)
    return x


def _narrowed(objective: Objective) -> Objective:
    """Narrow the limits by the reserve of the search."""
    limits, less = objective.limits, 1.0 - MARGIN
    gap = MARGIN * limits.span
    narrow = replace(
        limits,
        lower=limits.lower + gap,
        upper=limits.upper - gap,
        velocity=less * limits.velocity,
        acceleration=less * limits.acceleration,
        torque=less * limits.torque,
        clearance=limits.clearance and replace(limits.clearance, distance=limits.clearance.distance + GAP),
    )
    return replace(objective, limits=narrow)


def _within_limits(objective: Objective, x: FloatArray) -> FloatArray | None:
    """Scale motions until they are within the limits on a fine grid; None if the factor is too small."""
    scaled = x.copy()
    for each, pitch in zip(scaled, objective.pitches, strict=True):
        factor = 1.0
        while objective.excess(_fine(objective, each), float(pitch)) > 0.0:
            factor *= SHRINK
            each[1:] *= SHRINK
            if factor < SMALLEST:
                return None
    return scaled


def _fine(objective: Objective, x: FloatArray) -> States:
    samples = FINER * len(objective.basis.position)
    return objective.basis.motion(x, objective.seconds, 0.0).period_samples(samples)


def _no_motion(objective: Objective, x: FloatArray) -> ExoidError:
    """Error that names the limit which the motion exceeds most."""
    tilted = zip(x, objective.pitches, strict=True)
    excess = np.sum([objective.excesses(_fine(objective, each), float(pitch)) for each, pitch in tilted], axis=0)
    worst = EXCESSES[int(np.argmax(excess))]
    return ExoidError(
        f"no motion was found within the limits; the {worst} limit is exceeded most",
        where=objective.model.leg.description.name,
        remedy=f"widen the {worst} limit or the angles, or use more starts",
    )
