"""Output error: the parameters with which a simulated loop behaves as the real one did (DIDIM)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError, ExoidError, NotSupportedError
from exoid.identification.problem import Problem
from exoid.regression.every_row import make_rows
from exoid.regression.fit import Fit, correlated_covariance, wls
from exoid.regression.least_squares import RFactor, Solution, factorize, solve
from exoid.regression.residuals import Point, fit_noise
from exoid.regression.rows import for_leg, source_of
from exoid.signals import Poses

from .closed_loop import ClosedLoop
from .outside_rows import LinearisedRows, default_start, linearised_block, refuse_other_friction

ROUNDS = 12  # Gauss–Newton steps at most
HALVINGS = 6  # a step that does not reduce the sum of squares is halved so often
SETTLED = 1e-2  # converged when no parameter moves by more than this part of its standard deviation,
EXACT = 1e-9  # or by this part of itself


@dataclass(frozen=True)
class OutputError:
    """Output error: simulate the closed loop with the model, and match measured angles and torques.

    Gauss–Newton from weighted least squares, with halved steps. Derivatives are differences of rigs simulated side by
    side, one for each parameter. Angles and torques of each joint are weighted by their residuals. Nothing measured
    enters the regressor, so that noise in the angles biases nothing, and no filter is needed: the most precise
    estimator where the loop is known and the model is right. Friction and rotor inertia are kept from being negative.
    The covariance allows for correlated residuals.

    Attributes:
        loop: Controller, reference and actuator of all recordings.
    """

    fits_samples: ClassVar[bool] = True  # no filter makes rows, so that neither cut-off nor preparation applies
    name: ClassVar[str] = "output-error"
    loop: ClosedLoop | None = None

    def __call__(self, problem: Problem) -> Fit:
        """Fit.

        A problem without a loop, with a payload or with several groups is refused.
        """
        model = problem.model
        if self.loop is None:
            raise BadArgumentError(
                "output error simulates the loop, and must know its controller and reference",
                remedy="pass estimator=OutputError(ClosedLoop(controller, reference)), or use ml, which needs neither",
            )
        refuse_other_friction(model, "output error")
        problem.refuse_beside_leg("output error", moving_base=False)
        first = wls(problem)
        matching = _Matching(self.loop, problem)
        start = default_start(problem)  # friction and rotor inertia that are negative cannot be simulated
        values = np.where(model.nonnegative, np.maximum(start, 0.0), start)
        answer = matching.answer(values, np.sqrt(np.diag(first.solution.covariance)))
        converged = False
        for _ in range(ROUNDS):
            scales = answer.scales()
            solution = matching.solve(answer, scales, values)
            step, std = solution.values - values, np.sqrt(np.diag(solution.covariance))
            converged = bool((np.abs(step) <= np.maximum(SETTLED * std, EXACT * np.abs(values))).all())
            if converged:
                break
            moved = _descend(matching, answer, scales, values, step, std)
            if moved is None:
                converged = True  # no step reduces the sum of squares any further
                break
            values, answer = moved
        return _as_fit(matching, first, values, answer, converged)


class _Missed(NamedTuple):
    """What the simulation misses of the C channels of one recording."""

    time: FloatArray | None  # stamps [s]; None for poses
    levels: slice  # places of their noise levels: angles and torques of all joints, then torques of poses
    residual: FloatArray  # (N, C)
    J: FloatArray  # derivatives of the prediction by β, (N, C, P)


class _Answer(NamedTuple):
    """What the simulation misses of all recordings."""

    recordings: Sequence[_Missed]

    def weighted(self, scales: FloatArray) -> list[tuple[FloatArray, FloatArray]]:
        """Derivatives and residuals of each recording over the noise levels."""
        return [(each.J / scales[each.levels, None], each.residual / scales[each.levels]) for each in self.recordings]

    def rows(self, scales: FloatArray, values: FloatArray) -> LinearisedRows:
        """Weighted rows, linearised about values."""
        pairs = zip(self.weighted(scales), self.recordings, strict=True)
        return LinearisedRows.of([linearised_block(*both, values, each.time) for both, each in pairs])

    def scales(self) -> FloatArray:
        """Root mean square residual of each level."""
        total, count = np.zeros((2, max(each.levels.stop for each in self.recordings)))
        for each in self.recordings:
            total[each.levels] += (each.residual**2).sum(axis=0)
            count[each.levels] += len(each.residual)
        tiny = np.finfo(float).tiny
        return np.asarray(np.maximum(np.sqrt(total / np.maximum(count, 1.0)), tiny**0.25))

    def squares(self, scales: FloatArray) -> float:
        """Weighted sum of squares."""
        return sum(float((residual**2).sum()) for _, residual in self.weighted(scales))

    def r_factor(self, scales: FloatArray, values: FloatArray) -> RFactor:
        """Of the weighted rows, linearised about values."""
        tables = [np.dstack([W, residual + W @ values]) for W, residual in self.weighted(scales)]
        table = np.vstack([each.reshape(-1, len(values) + 1) for each in tables])
        return factorize(table, len(table), float(len(table)))


class _Matching(NamedTuple):
    loop: ClosedLoop
    problem: Problem

    def solve(self, answer: _Answer, scales: FloatArray, values: FloatArray) -> Solution:
        """One Gauss–Newton step, with what is known beside the recordings, and nothing negative that cannot be."""
        prior_knowledge, model = replace(self.problem.prior_knowledge, nonnegative=True), self.problem.model
        return solve(answer.r_factor(scales, values), model.names, prior_knowledge, model.nonnegative)

    def squares(self, answer: _Answer, scales: FloatArray, values: FloatArray) -> float:
        """Weighted sum of squares, priors among them."""
        priors = self.problem.prior_knowledge.pseudo_rows(self.problem.names) @ np.append(values, -1.0)
        return answer.squares(scales) + float(priors @ priors)

    def answer(self, values: FloatArray, std: FloatArray) -> _Answer:
        """Simulate at values and beside them."""
        model = self.problem.model
        # Part of a parameter by which it is changed to see what the simulation answers
        change = np.maximum(1e-3 * np.abs(values), 0.1 * std)
        beside = values[:, None] + np.column_stack([np.zeros(len(values)), np.diag(change)])
        missed: list[_Missed] = []
        n = len(model.leg.joint_names)
        for data in self.problem.local_data:
            if isinstance(data, Poses):
                rows = make_rows(model, data, self.problem.preparation)
                missed.append(_Missed(None, slice(2 * n, 3 * n), rows.tau - rows.W @ values, rows.W))
                continue
            recording = for_leg(model, data).resampled()
            if recording.mask is not None:
                raise NotSupportedError(
                    "output error simulates whole recordings, and this one has segments",
                    where=source_of(recording),
                    remedy="cut them out with Recording.between, or use wls",
                )
            ran = self.loop.simulate(model, beside, recording)
            simulated = np.concatenate([ran.q, ran.tau], axis=1)
            residual = np.hstack([recording.q, np.asarray(recording.tau)]) - simulated[..., 0]
            J = (simulated[..., 1:] - simulated[..., :1]) / change
            missed.append(_Missed(recording.time, slice(0, 2 * n), residual, J))
        return _Answer(missed)


def _descend(
    matching: _Matching, answer: _Answer, scales: FloatArray, values: FloatArray, step: FloatArray, std: FloatArray
) -> tuple[FloatArray, _Answer] | None:
    """Halve the step until the sum of squares falls; None where it does not."""
    before = matching.squares(answer, scales, values)
    for halving in range(HALVINGS):
        there = values + 0.5**halving * step
        try:
            found = matching.answer(there, std)
        except ExoidError:  # a step too far diverges
            continue
        if matching.squares(found, scales, there) < before:
            return there, found
    return None


def _as_fit(matching: _Matching, first: Fit, values: FloatArray, answer: _Answer, converged: bool) -> Fit:
    scales, problem = answer.scales(), matching.problem
    solution = matching.solve(answer, scales, values)
    correlated = correlated_covariance(answer.rows(scales, values), Point(values, [1.0]), solution)
    noises = fit_noise(problem, Point(values, first.weights), correlated.matrix)
    warnings = () if converged else ("output error has not converged: check controller and reference",)
    solution = solution._replace(
        values=values,
        inverse=first.solution.inverse,
        prior_noise=first.solution.prior_noise,
        bounded=(),
    )
    return Fit(solution, first.weights, noises=noises, warnings=warnings, correlated=correlated)
