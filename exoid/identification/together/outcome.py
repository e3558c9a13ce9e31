"""What a fit of several groups says of each of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from exoid._typing import FloatArray
from exoid.estimate.estimate import Estimate, Input
from exoid.identification.estimators import Fit
from exoid.identification.recording_summary import Survey, angles
from exoid.regression.diagnostics import JointNoise, calm_sizes, judge_noise, judge_sizes, negative
from exoid.regression.influence import Influence, leave_out
from exoid.regression.r_factor import Triangle, join, rms_residual
from exoid.regression.residuals import Noises, Point
from exoid.regression.trends import Trend, remarks, residual_trends

from .problem import JointProblem
from .trust import condition_number, noise_of


@dataclass(frozen=True, eq=False)
class Outcome:
    """A fit of several groups.

    Attributes:
        problem: The problem.
        surveys: Of the recordings of each group.
        fit: Its solution.
        estimator: Name of the estimator.
        covariance: Of all parameters, (P, P).
        noises: Noise of each kind and joint.
        dofs: Degrees of freedom of each parameter's variance by what is known of the noise, (P,); None if it is white.
        white: Whether the covariance assumes white noise.
    """

    problem: JointProblem
    surveys: Sequence[Sequence[Survey]]
    fit: Fit
    estimator: str
    covariance: FloatArray
    noises: Noises
    dofs: FloatArray | None
    white: bool

    @staticmethod
    def of(
        problem: JointProblem, surveys: Sequence[Sequence[Survey]], fit: Fit, estimator: str, *, white: bool
    ) -> Outcome:
        """Find noise and covariance of a fit."""
        return Outcome(problem, surveys, fit, estimator, *noise_of(problem, fit, white=white), white)

    @cached_property
    def noise(self) -> list[tuple[JointNoise, ...]]:
        """What the residuals of each group's joints look like."""
        return [
            judge_noise(problem, self.point(group), self.problem.noises_of(group, self.noises))
            for group, problem in enumerate(self.problem.problems)
        ]

    @property
    def samples(self) -> list[float]:
        """Independent samples of each group."""
        if self.white:
            counts = np.array([sum(triangle.samples for triangle in p.triangles) for p in self.problem.problems])
            total = self.fit.solution.dof + np.count_nonzero(self.problem.assumed.free(self.problem.names))
            return list(counts * total / counts.sum())
        return [sum(joint.effective_samples for joint in joints) for joints in self.noise]

    @cached_property
    def inputs(self) -> tuple[Input, ...]:
        """All recordings: the errors of every group come from all of them."""
        return tuple(one.evidence for surveys in self.surveys for one in surveys)

    @cached_property
    def calm_sizes(self) -> list[FloatArray]:
        """Of parameters that would explain all torque of a calm exercise alone, for each group."""
        pairs = zip(self.problem.problems, self.surveys, strict=True)
        return [calm_sizes(problem.model, *angles(surveys), problem.triangles) for problem, surveys in pairs]

    @cached_property
    def influence(self) -> Influence | None:
        """Influence of each recording on all parameters; nothing for one recording."""
        if len(self.inputs) < 2:
            return None
        each = self.problem.recordings(self.fit.weights)
        whole = self.problem.solve(join(each))
        names, std = [source.name for source in self.inputs], np.sqrt(np.diag(self.covariance))

        def without(index: int, others: Triangle) -> FloatArray:
            return self.problem.without(index, others, whole.values)

        return leave_out(each, names, without, whole, std)

    def point(self, group: int) -> Point:
        """Where residuals of one group are to be looked at."""
        values = self.fit.solution.values[self.problem.layout.places[group]]
        return Point(values, self.problem.weights_of(group, self.fit.weights), self.fit.clip)

    def trends(self, group: int) -> tuple[Trend, ...]:
        """Residuals of one group against velocity and angle."""
        places, noises = self.problem.layout.places[group], self.problem.noises_of(group, self.noises)
        block = np.ix_(places, places)
        solution = self.fit.solution._replace(inverse=self.fit.solution.inverse[block])
        alone, whitened = self.problem.problems[group], self.fit.noises is not None
        return residual_trends(alone, self.point(group), noises, solution, self.covariance[block], whitened=whitened)

    def estimate(self, group: int, dof: float, dofs: FloatArray, doubts: tuple[str, ...]) -> Estimate:
        """Make the estimate of one group, its covariance the group's block of the whole.

        Args:
            group: Its index.
            dof: Degrees of freedom of its residuals.
            dofs: Of the variance of each of all parameters, (P,).
            doubts: Warnings that all groups have in common.
        """
        layout, solution = self.problem.layout, self.fit.solution
        alone, places = self.problem.problems[group], layout.places[group]
        values, covariance = solution.values[places], self.covariance[np.ix_(places, places)]
        trends, names = self.trends(group), layout.names_of(group)
        bounded = [self.problem.names[k] for k in solution.bounded]
        own_doubts = (*negative(alone.model, values, np.sqrt(np.diag(covariance))), *remarks(trends))
        return Estimate(
            model=alone.model,
            values=values,
            covariance=covariance,
            condition_number=condition_number(solution.inverse, places),
            dof=float(dof),
            dof_each=dofs[places],
            residual_rms=np.array([rms_residual(joint, values) for joint in zip(*alone.groups, strict=True)]),
            estimator=self.fit.name or self.estimator,
            preparation=alone.preparation,
            inputs=self.inputs,
            noise=self.noise[group],
            sizes=judge_sizes(alone.triangles),
            calm_sizes=self.calm_sizes[group],
            collinearity=solution.collinearity.indices[places],
            prior_gains=self._prior_gains(group),
            warnings=(*doubts, *own_doubts),
            assumed=layout.assumed_by(group, self.problem.assumed),
            bounded=tuple(names[name] for name in bounded if name in names),
            influence=None if self.influence is None else self.influence.at(places),
            trends=trends,
        )

    def _prior_gains(self, group: int) -> FloatArray:
        """How far the parameters of one group follow its priors, (P, K)."""
        layout, assumed = self.problem.layout, self.problem.assumed
        names = layout.names_of(group)
        mine = [k for k, name in enumerate(assumed.prior.values) if name in names]
        if not mine:
            return np.zeros((0, 0))
        return self.fit.solution.prior_gains(layout.names, assumed)[layout.places[group]][:, mine]
