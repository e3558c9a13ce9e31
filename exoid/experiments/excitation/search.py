"""Search for the best motion from several starts."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.experiments.references import States

from .fourier import FourierMotion
from .objective import Objective, Stage

STAGES = {
    "worst": (Stage(1.0, 30.0), Stage(4.0, 300.0), Stage(16.0, 3e3), Stage(40.0, 3e4, 150)),
    "d": (Stage(0.0, 30.0), Stage(0.0, 3e3), Stage(0.0, 3e4, 150)),
}
"""Stages of each criterion. All starts pass the first, with a low penalty, and the better half of them the others."""


def search(
    objective: Objective, criterion: str, starts: int, seed: int, progress: Callable[[float], None] | None = None
) -> tuple[FourierMotion, ...]:
    """Draw motions, optimise all in a first stage and the better half in all stages, and keep the best."""
    report, (first, *later) = progress or (lambda _: None), STAGES[criterion]
    inner = objective.narrowed()
    better = max(1, (starts + 1) // 2)
    total, done = starts * first.iterations + better * sum(stage.iterations for stage in later), 0
    drawn: list[tuple[float, FloatArray]] = []  # value of the objective, and coefficients of the motions, flattened
    for generator in np.random.default_rng(seed).spawn(starts):
        drawn.append(_minimise(inner, objective.draw(generator), first))
        done += first.iterations
        report(done / total)
    drawn.sort(key=lambda each: each[0])
    finished: list[tuple[float, FloatArray]] = []
    for number, (_, x) in enumerate(drawn):
        if number >= better and finished:
            break
        for stage in later:
            _, x = _minimise(inner, x, stage)  # noqa: PLW2901
            done += stage.iterations
            report(min(done / total, 1.0))
        fitting = _within_limits(objective, x)
        if fitting is not None:
            finished.append((objective(fitting, Stage(later[-1].power, 0.0))[0], fitting))
    if not finished:
        motions = enumerate(objective.coefficients(x))
        excesses = np.sum([objective.excesses_of(k, _fine(objective, one)) for k, one in motions], axis=0)
        worst = objective.limit_names[int(np.argmax(excesses))]
        raise BadArgumentError(
            f"no motion was found within the limits; the {worst} limit is exceeded most",
            where=objective.model.leg.description.name,
            remedy=f"widen the {worst} limit or the angles, or use more starts",
        )
    _, best = min(finished, key=lambda each: each[0])
    tilted = zip(objective.coefficients(best), objective.pitches, strict=True)
    return tuple(objective.basis.motion(x, objective.seconds, float(pitch)) for x, pitch in tilted)


def _minimise(objective: Objective, x: FloatArray, stage: Stage) -> tuple[float, FloatArray]:
    """Minimise by L-BFGS."""
    result = scipy.optimize.minimize(
        objective, x, args=(stage,), jac=True, method="L-BFGS-B", options={"maxiter": stage.iterations, "maxcor": 20}
    )
    return float(result.fun), np.asarray(result.x)


def _within_limits(objective: Objective, x: FloatArray) -> FloatArray | None:
    """Scale motions until they are within the limits on a fine grid; None if the factor is too small."""
    scaled = x.copy()
    for number, each in enumerate(objective.coefficients(scaled)):
        factor = 1.0
        while objective.excesses_of(number, _fine(objective, each)).any():
            factor *= 0.998
            each[1:] *= 0.998
            if factor < 0.5:
                return None
    return scaled


def _fine(objective: Objective, x: FloatArray) -> States:
    samples = 10 * len(objective.basis.position)  # a grid so much finer than that of the search
    return objective.basis.motion(x, objective.seconds, 0.0).period_samples(samples)
