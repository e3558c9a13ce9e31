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


class _Series(NamedTuple):
    """Residuals of one output in time order, and its derivatives: (N,) and (N, P)."""

    group: int
    residual: FloatArray
    J: FloatArray


class _Answer(NamedTuple):
    """What the simulation misses, output by output; a group of outputs shares a noise level."""

    recordings: Sequence[Sequence[_Series]]  # outputs of each recording: angles and torques, or torques of poses
    stamps: Sequence[FloatArray | None]  # stamps of each recording [s]; None for poses

    @property
    def series(self) -> list[_Series]:
        """Outputs of all recordings."""
        return [part for parts in self.recordings for part in parts]

    def rows(self, scales: FloatArray, values: FloatArray) -> LinearisedRows:
        """Weighted rows, linearised about values."""
        blocks = []
        for parts, time in zip(self.recordings, self.stamps, strict=True):
            W = np.stack([part.J / scales[part.group] for part in parts], axis=1)
            residual = np.column_stack([part.residual / scales[part.group] for part in parts])
            blocks.append(linearised_block(W, residual, values, time))
        return LinearisedRows.of(blocks)

    def scales(self) -> FloatArray:
        """Root mean square residual of each group."""
        groups = 1 + max(part.group for part in self.series)
        total, count = np.zeros((2, groups))
        for part in self.series:
            total[part.group] += part.residual @ part.residual
            count[part.group] += len(part.residual)
        tiny = np.finfo(float).tiny
        return np.maximum(np.sqrt(total / np.maximum(count, 1.0)), tiny**0.25)

    def squares(self, scales: FloatArray) -> float:
        """Weighted sum of squares."""
        return sum(float(np.sum((part.residual / scales[part.group]) ** 2)) for part in self.series)

    def r_factor(self, scales: FloatArray, values: FloatArray) -> RFactor:
        """Of the weighted rows, linearised about values."""
        tables = [
            np.column_stack([part.J, part.residual + part.J @ values]) / scales[part.group] for part in self.series
        ]
        table = np.vstack(tables)
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
        recordings: list[list[_Series]] = []
        stamps: list[FloatArray | None] = []
        n = len(model.leg.joint_names)
        for data in self.problem.local_data:
            if isinstance(data, Poses):
                rows = make_rows(model, data, self.problem.preparation)
                residual = rows.tau - rows.W @ values
                recordings.append([_Series(2 * n + j, residual[:, j], rows.W[:, j]) for j in range(n)])
                stamps.append(None)
                continue
            recording = for_leg(model, data).resampled()
            if recording.mask is not None:
                raise NotSupportedError(
                    "output error simulates whole recordings, and this one has segments",
                    where=source_of(recording),
                    remedy="cut them out with Recording.between, or use wls",
                )
            series: list[_Series] = []
            ran = self.loop.simulate(model, beside, recording)
            for group, (measured, simulated) in enumerate(((recording.q, ran.q), (np.asarray(recording.tau), ran.tau))):
                J = (simulated[..., 1:] - simulated[..., :1]) / change
                residual = measured - simulated[..., 0]
                series += [_Series(group * n + j, residual[:, j], J[:, j]) for j in range(n)]
            recordings.append(series)
            stamps.append(recording.time)
        return _Answer(recordings, stamps)


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
