"""Searching for the best motion from several starts."""

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
"""Times as fine as the search's grid, on which limits are checked."""

SHRINK = 0.998
"""Factor by which a motion is made smaller about its centre until it keeps the limits."""

SMALLEST = 0.5
"""A motion that must be shrunk to less than this keeps no limits."""

MARGIN = 0.004
"""Part of each limit that the search leaves for what is between its samples."""

GAP = 0.003
"""Distance of the foot that it leaves besides [m]."""

FIRST = {"worst": Stage(1.0, 30.0), "a": Stage(1.0, 30.0), "d": Stage(0.0, 30.0)}
"""First stage for each criterion, smooth and soft; all starts go through it."""

LAST = {
    "worst": (Stage(4.0, 300.0), Stage(16.0, 3e3), Stage(40.0, 3e4)),
    "a": (Stage(1.0, 3e3), Stage(1.0, 3e4)),
    "d": (Stage(0.0, 3e3), Stage(0.0, 3e4)),
}
"""Later ones, for the better half of the starts."""

ITERATIONS = 60
"""Of each stage but the last,"""

LAST_ITERATIONS = 150
"""and of the last."""


class Candidate(NamedTuple):
    """Motions on their way.

    Attributes:
        cost: What is minimised.
        x: Coefficients, (T, m, n).
    """

    cost: float
    x: FloatArray


class Found(NamedTuple):
    """Result of a search.

    Attributes:
        motions: One for each torso tilt.
        costs: What was minimised, of all starts that went through all stages, the best first.
    """

    motions: tuple[FourierMotion, ...]
    costs: tuple[float, ...]


def search(
    objective: Objective,
    criterion: str,
    starts: int,
    seed: int | np.random.Generator,
    progress: Callable[[float], None] | None = None,
) -> Found:
    """Draw motions, improve all of them roughly and the better half as far as possible, and keep the best.

    Args:
        objective: What is minimised.
        criterion: "worst", "a" or "d".
        starts: How many motions are drawn.
        seed: Of the draws.
        progress: Told the share that is done.

    Raises:
        ExoidError: No motion that was found keeps the limits.
    """
    told, last = progress or (lambda _: None), LAST[criterion]
    inner = _inner(objective)
    better = max(1, (starts + 1) // 2)
    total, done = starts + better * (len(last) + 1.5), 0.0
    drawn: list[Candidate] = []
    for generator in np.random.default_rng(seed).spawn(starts):
        drawn.append(_improved(inner, _draw(objective, generator), FIRST[criterion], ITERATIONS))
        done += 1.0
        told(done / total)
    drawn.sort(key=lambda candidate: candidate.cost)
    finished: list[Candidate] = []
    for number, candidate in enumerate(drawn):
        if number >= better and finished:
            break
        for stage in last:
            final = stage is last[-1]
            candidate = _improved(inner, candidate.x, stage, LAST_ITERATIONS if final else ITERATIONS)  # noqa: PLW2901
            done += 2.5 if final else 1.0
            told(min(done / total, 1.0))
        x = _within(objective, candidate.x)
        if x is not None:
            finished.append(Candidate(objective(x.ravel(), Stage(last[-1].power, 0.0))[0], x))
    if not finished:
        raise _impossible(objective, candidate.x)
    finished.sort(key=lambda candidate: candidate.cost)
    motions = zip(finished[0].x, objective.pitches, strict=True)
    return Found(
        tuple(objective.basis.motion(x, objective.seconds, float(pitch)) for x, pitch in motions),
        tuple(candidate.cost for candidate in finished),
    )


def _improved(objective: Objective, x: FloatArray, stage: Stage, iterations: int) -> Candidate:
    """Descend by L-BFGS."""
    result = scipy.optimize.minimize(
        objective, x.ravel(), args=(stage,), jac=True, method="L-BFGS-B", options={"maxiter": iterations, "maxcor": 20}
    )
    return Candidate(float(result.fun), np.asarray(result.x).reshape(objective.shape))


def _draw(objective: Objective, rng: np.random.Generator) -> FloatArray:
    """Draw coefficients, and scale each joint's to most of what angle, speed and acceleration allow."""
    limits, basis = objective.limits, objective.basis
    x = rng.standard_normal(objective.shape)
    for each in x:
        q, v, a = (part[:, 1:] @ each[1:] for part in (basis.position, basis.velocity, basis.acceleration))
        room = np.array(
            [
                limits.span / np.ptp(q, axis=0),
                limits.velocity / np.abs(v).max(axis=0),
                limits.acceleration / np.abs(a).max(axis=0),
            ]
        )
        scale = rng.uniform(0.5, 0.95) * room.min(axis=0)
        each[1:] *= scale
        middle = 0.5 * scale * (q.max(axis=0) + q.min(axis=0))
        left = limits.span - scale * np.ptp(q, axis=0)
        each[0] = 0.5 * (limits.lower + limits.upper) - middle + 0.3 * left * rng.uniform(-1.0, 1.0, left.shape)
    return x


def _inner(objective: Objective) -> Objective:
    """Narrow the limits a little."""
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


def _within(objective: Objective, x: FloatArray) -> FloatArray | None:
    """Shrink motions until they keep the limits on a fine grid; None where that leaves too little."""
    kept = x.copy()
    for each, pitch in zip(kept, objective.pitches, strict=True):
        factor = 1.0
        while objective.excess(_fine(objective, each), float(pitch)) > 0.0:
            factor *= SHRINK
            each[1:] *= SHRINK
            if factor < SMALLEST:
                return None
    return kept


def _fine(objective: Objective, x: FloatArray) -> States:
    samples = FINER * len(objective.basis.position)
    return objective.basis.motion(x, objective.seconds, 0.0).period_samples(samples)


def _impossible(objective: Objective, x: FloatArray) -> ExoidError:
    """Say which limit was in the way of the best motion."""
    tilted = zip(x, objective.pitches, strict=True)
    excess = np.sum([objective.excesses(_fine(objective, each), float(pitch)) for each, pitch in tilted], axis=0)
    worst = EXCESSES[int(np.argmax(excess))]
    return ExoidError(
        f"no motion was found within the limits; the {worst} limit is in the way most",
        where=objective.model.leg.description.name,
        remedy=f"widen the {worst} limit, the angles, or allow more starts",
    )
