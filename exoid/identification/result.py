"""Result of a fit: noise, covariance and evidence, and the estimate of each group."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.estimate.data import Input
from exoid.estimate.equality import own_equality
from exoid.estimate.estimate import Estimate
from exoid.estimate.grouped import GroupedEstimate
from exoid.estimate.nonlinear import NO_NONLINEAR_PARAMETERS, NonlinearParameters
from exoid.estimate.support import Support
from exoid.regression.diagnostics import (
    Collinearity,
    JointNoise,
    condition_number,
    describe_noise,
    parameter_scale,
    reference_scale,
    short_runs,
)
from exoid.regression.fit import SamplesLeft, Uncertainty, samples_left, uncertainty_of
from exoid.regression.influence import Influence, influence
from exoid.regression.least_squares import rms_residual
from exoid.regression.trends import Trend, residual_trends, trend_warnings
from exoid.signals import Recording
from exoid.torques import TorqueModel
from exoid.torques.contacts.support_model import LOOP

from .agreement import Agreement, shared_agreement
from .checkup import check_group, model_error
from .estimators.by_name import name_of
from .findings.checkup import Checkup
from .findings.physics import never_negative
from .fitting import Fitted, Task
from .recording_summary import angles
from .sole_compliance import SoleCompliance


@dataclass(frozen=True, eq=False)
class Result:
    """A fit with what its residuals say."""

    task: Task  # what was fitted, and what was mended before
    fitted: Fitted  # the fit
    uncertainty: Uncertainty  # covariance of all parameters, and the noise that it is for
    check: bool  # whether to check logs and fit for faults

    @classmethod
    def of(cls, task: Task, fitted: Fitted, *, white: bool, check: bool) -> Result:
        """Find noise and covariance of a fit."""
        return cls(task, fitted, uncertainty_of(fitted.problem, fitted.fit, white=white), check)

    def estimate(self) -> Estimate:
        """Make the estimate of the only group."""
        return self._estimate_of(0, self._common_warnings)

    def grouped_estimate(self) -> GroupedEstimate:
        """Make the estimates of all groups."""
        problem, solution, layout = self.fitted.problem, self.fitted.fit.solution, self.fitted.problem.layout
        agreement = self._agreement
        common = (*self._common_warnings, *agreement.warnings)
        estimates = {group: self._estimate_of(k, common) for k, group in enumerate(layout.groups)}
        covariance, dofs = self.uncertainty.covariance, self._degrees_of_freedom
        return GroupedEstimate(
            estimates=estimates,
            layout=layout,
            values=solution.values,
            covariance=covariance,
            dof_each=dofs,
            parameter_scale=parameter_scale(problem.r_factors),
            reference_scale=self._smallest_reference_scale(),
            collinearity=self._collinearity.indices,
            condition_number=solution.condition_number,
            prior_knowledge=problem.prior_knowledge,
            equal=own_equality(layout, solution.values, covariance, dofs),
            agreement=agreement.equality,
            bounded=tuple(problem.names[k] for k in solution.bounded),
            warnings=(*common, *_own_warnings(estimates, len(common))),
            notes=(*self._regrouped_notes(), *agreement.notes),
        )

    def standing_estimate(self, model: TorqueModel, soles: SoleCompliance | None = None) -> Estimate:
        """Make the one estimate of groups that share all parameters: sets of links that rest on the ground."""
        problem, fit = self.fitted.problem, self.fitted.fit
        solution, values = fit.solution, self.fitted.values
        covariance, groups = self.uncertainty.covariance, range(len(problem.groups))
        if soles is not None:
            covariance = covariance + soles.of_parameters
        supports = tuple(self._support(group) for group in groups)
        bounded = tuple(problem.names[k] for k in solution.bounded)
        return Estimate(
            model=model,
            values=values,
            covariance=covariance,
            condition_number=solution.condition_number,
            dof=float(self._samples_left.groups.sum()),
            dof_each=self._degrees_of_freedom,
            residual_rms=np.array([_of_joint(supports, joint) for joint in model.joint_names]),
            estimator=fit.name or name_of(self.task.estimator),
            preparation=problem.groups[0].preparation,
            inputs=tuple(dict.fromkeys(self._inputs)),
            parameter_scale=parameter_scale(problem.r_factors),
            reference_scale=self._smallest_reference_scale(),
            collinearity=self._collinearity.indices,
            warnings=(*self._common_warnings, *negative(model, values, np.sqrt(np.diag(covariance)))),
            prior_knowledge=problem.prior_knowledge,
            bounded=bounded,
            findings=self.task.findings_with(0, ()),
            cutoff_source=self.task.cutoff_source,
            actuators=self.task.actuators[0] if self.task.actuators else None,
            supports=supports,
        )

    def _support(self, group: int) -> Support:
        """Describe the rows of one set of links that rest."""
        problem = self.fitted.problem
        rows, places = problem.groups[group], problem.layout.places[group]
        values = self.fitted.fit.solution.values[places]
        rms = [rms_residual(of_row, values) for of_row in zip(*rows.by_kind, strict=True)]
        seconds = sum(
            float(np.count_nonzero(one.mask)) / one.sample_rate
            for one in rows.data
            if isinstance(one, Recording) and one.mask is not None
        )
        name = problem.layout.groups[group]
        return Support(name, seconds, dict(zip(rows.model.row_names, rms, strict=True)))

    def _estimate_of(self, group: int, common: tuple[str, ...]) -> Estimate:
        """Make the estimate of one group, its covariance the group's block of the whole."""
        problem, fit, model = self.fitted.problem, self.fitted.fit, self.fitted.models[group]
        layout, solution, rows = problem.layout, fit.solution, problem.groups[group]
        every = layout.places[group]  # nonlinear parameters stand behind the others
        count = len(model.names)
        places = every[:count]
        values, covariance = self.fitted.values[places], self.uncertainty.covariance[np.ix_(places, places)]
        trends, names = self._trends_of(group), layout.names_of(group)
        bounded = [problem.names[k] for k in solution.bounded]
        alone = len(problem.groups) == 1
        actuators = self.task.actuators[group] if self.task.actuators else None
        checkup = check_group(self.fitted, group, covariance, actuators) if self.check else Checkup()
        residual_rms = np.array(
            [rms_residual(of_joint, solution.values[every]) for of_joint in zip(*rows.by_kind, strict=True)]
        )
        noise = self._noise_of(group)
        return Estimate(
            model=model,
            values=values,
            covariance=covariance,
            condition_number=solution.condition_number if alone else condition_number(solution.inverse, every),
            dof=float(self._samples_left.groups[group]),
            dof_each=self._degrees_of_freedom[places],
            residual_rms=residual_rms,
            estimator=fit.name or name_of(self.task.estimator),
            preparation=rows.preparation,
            inputs=self._inputs,
            noise=noise,
            parameter_scale=parameter_scale(rows.r_factors)[:count],
            reference_scale=self._reference_scales[group],
            collinearity=self._collinearity.indices[places],
            prior_gains=self._prior_gains(group)[:count],
            warnings=(*common, *negative(model, values, np.sqrt(np.diag(covariance))), *trend_warnings(trends)),
            nonlinear=self._nonlinear,
            prior_knowledge=layout.known_by(group, problem.prior_knowledge),
            bounded=tuple(names[name] for name in bounded if name in names),
            influence=None if self._influence is None else self._influence.at(places),
            trends=trends,
            findings=self.task.findings_with(group, checkup.findings),
            ranges=checkup.ranges,
            model_error=model_error(self.fitted, group, checkup, residual_rms, noise) if self.check else None,
            cutoff_source=self.task.cutoff_source,
            torque_delays=self.task.delays[group] if self.task.delays else np.zeros(0),
            actuators=actuators,
            torque_spread=np.zeros(0) if checkup.torque_spread is None else checkup.torque_spread,
        )

    @cached_property
    def _common_warnings(self) -> tuple[str, ...]:
        """Warnings of the fit as a whole."""
        nonlinear = () if self._nonlinear is NO_NONLINEAR_PARAMETERS else self._nonlinear.warnings
        problem, uncertainty = self.fitted.problem, self.uncertainty
        short = () if uncertainty.white else short_runs(uncertainty.noises, problem.joint_names)
        return (*self.fitted.warnings, *nonlinear, *self._collinearity.warnings(problem.names), *short)

    @cached_property
    def _collinearity(self) -> Collinearity:
        """Parameters that the rows can hardly tell apart."""
        return Collinearity.of(self.fitted.fit.solution)

    @cached_property
    def _nonlinear(self) -> NonlinearParameters:
        """Nonlinear parameters with their covariance."""
        if self.fitted.nonlinear is NO_NONLINEAR_PARAMETERS:
            return self.fitted.nonlinear
        count = len(self.fitted.values)
        names = self.fitted.problem.names[count:]
        return self.fitted.nonlinear.with_covariance(names, self.uncertainty.covariance[count:, count:])

    @cached_property
    def _inputs(self) -> tuple[Input, ...]:
        """Evidence of all recordings: the errors of every group come from all of them."""
        return tuple(summary.evidence for of_group in self.task.summaries for summary in of_group)

    @cached_property
    def _noise(self) -> tuple[JointNoise, ...]:
        """Description of the residuals of each joint, group by group."""
        return describe_noise(self.fitted.problem, self.fitted.fit.point, self.uncertainty.noises)

    def _noise_of(self, group: int) -> tuple[JointNoise, ...]:
        first, end = self.fitted.problem.joints_of(group)
        return self._noise[first:end]

    @cached_property
    def _trends(self) -> dict[int, tuple[Trend, ...]]:
        """Residuals of each joint against velocity and angle."""
        fit, covariance = self.fitted.fit, self.uncertainty.stationary
        return residual_trends(
            self.fitted.problem,
            fit.point,
            self.uncertainty.noises,
            fit.solution,
            covariance,
            whitened=fit.noises is not None,
        )

    def _trends_of(self, group: int) -> tuple[Trend, ...]:
        joints = range(*self.fitted.problem.joints_of(group))
        return tuple(trend for joint in joints for trend in self._trends.get(joint, ()))

    @cached_property
    def _reference_scales(self) -> list[FloatArray]:
        """Parameters that would explain all torque of a calm exercise alone, for each group."""
        count = len(self.fitted.models[0].names)
        places = self.fitted.problem.layout.places
        return [
            reference_scale(model.loaded_by(self.fitted.values[of_group[:count]]), *angles(summaries), rows.r_factors)
            for model, of_group, summaries, rows in zip(
                self.fitted.models, places, self.task.summaries, self.fitted.problem.groups, strict=True
            )
        ]

    def _smallest_reference_scale(self) -> FloatArray:
        """Smallest reference scale that any group has for each parameter, (P,)."""
        layout = self.fitted.problem.layout
        smallest = np.full(len(layout.names), np.inf)
        for places, numbers in zip(layout.places, self._reference_scales, strict=True):
            smallest[places] = np.minimum(smallest[places], numbers)
        return smallest

    @cached_property
    def _samples(self) -> list[float]:
        """Independent samples of each group."""
        problem = self.fitted.problem
        if self.uncertainty.white:
            counts = np.array([sum(r_factor.samples for r_factor in rows.r_factors) for rows in problem.groups])
            total = self.fitted.fit.solution.dof + np.count_nonzero(problem.prior_knowledge.free(problem.names))
            return list(counts * total / counts.sum())
        groups = range(len(problem.groups))
        return [sum(joint.effective_samples for joint in self._noise_of(group)) for group in groups]

    @cached_property
    def _samples_left(self) -> SamplesLeft:
        """Independent samples less parameters."""
        problem, fit = self.fitted.problem, self.fitted.fit
        rows = [problem.rows_of(group, fit.weights) for group in range(len(problem.groups))]
        free = int(np.count_nonzero(problem.prior_knowledge.free(problem.names)))
        return samples_left(rows, fit.solution.inverse, self._samples, free)

    @cached_property
    def _degrees_of_freedom(self) -> FloatArray:
        """Degrees of freedom of each parameter's variance, (P,)."""
        left = self._samples_left.each
        return left if self.uncertainty.dofs is None else np.clip(self.uncertainty.dofs, 1.0, left)

    @cached_property
    def _influence(self) -> Influence | None:
        """Influence of each recording on all parameters; None for one recording."""
        if len(self._inputs) < 2:
            return None
        names, std = [source.name for source in self._inputs], np.sqrt(np.diag(self.uncertainty.covariance))
        return influence(self.fitted.problem, names, self.fitted.fit.weights, std)

    @cached_property
    def _agreement(self) -> Agreement:
        """Whether the groups, each identified alone, agree on what they share."""
        return shared_agreement(self.fitted.problem, self.task.estimator, self._samples, white=self.uncertainty.white)

    def _prior_gains(self, group: int) -> FloatArray:
        """How far the parameters of one group follow its priors, (P, K)."""
        problem, fit = self.fitted.problem, self.fitted.fit
        # ml and output error minimise something else
        follows_rows = fit.correlated is None and (fit.noises is None or fit.whitened)
        names = problem.layout.names_of(group)
        mine = [k for k, name in enumerate(problem.prior_knowledge.prior.values) if name in names]
        if not mine or not follows_rows:
            return np.zeros((0, 0))
        gains = fit.solution.prior_gains(problem.names, problem.prior_knowledge)
        return gains[problem.layout.places[group]][:, mine]

    def _regrouped_notes(self) -> tuple[str, ...]:
        """Say what is part of other parameters, and therefore shared if these are."""
        problem = self.fitted.problem
        apart = set(problem.names if len(problem.groups) < 2 else problem.layout.own)
        return tuple(
            f"{regrouped}" + ("" if set(regrouped.into) <= apart else ", and so the same in all groups")
            for regrouped in self.fitted.models[0].regrouped
        )


def _of_joint(supports: Sequence[Support], joint: str) -> float:
    """RMS residual of the rows of a joint, or else of closed chains, whose rows have the noise of one torque."""
    own = [(one.residual_rms[joint], one.seconds) for one in supports if joint in one.residual_rms]
    loops = [(rms, one.seconds) for one in supports for name, rms in one.residual_rms.items() if name.startswith(LOOP)]
    squares = np.array(own or loops or [(0.0, 1.0)])
    return float(np.sqrt(np.average(squares[:, 0] ** 2, weights=squares[:, 1])))


def _own_warnings(estimates: Mapping[str, Estimate], common: int) -> tuple[str, ...]:
    """Warnings of single groups, behind those that they share."""
    return tuple(f"{group}: {text}" for group, estimate in estimates.items() for text in estimate.warnings[common:])


def negative(model: TorqueModel, values: FloatArray, std: FloatArray) -> tuple[str, ...]:
    """Name friction, rotor inertia and a segment's J that are negative by more than their error."""
    # Probability with which a parameter that is zero would be said to be negative
    limit = float(scipy.stats.norm.ppf(1.0 - 0.005))
    below = never_negative(model) & (values < 0.0) & (values < -limit * std)
    if not below.any():
        return ()
    names = ", ".join(name for name, is_below in zip(model.names, below, strict=True) if is_below)
    return (
        f"{names} negative beyond error, which nature does not allow: a term is missing, a sign is wrong, or the "
        "torque is not that of this joint",
    )
