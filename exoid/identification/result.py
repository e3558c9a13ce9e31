"""Result of a fit: noise, covariance and evidence, and the estimate of each group."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import cast

import numpy as np

from exoid._typing import FloatArray
from exoid.estimate.comparison import equality_of
from exoid.estimate.data import Input
from exoid.estimate.estimate import Estimate
from exoid.estimate.evidence import Evidence, Support
from exoid.estimate.finding import ordered
from exoid.estimate.friction_cone import cone_findings
from exoid.estimate.grouped import GroupedEstimate
from exoid.estimate.nonlinear import NO_NONLINEAR_PARAMETERS, NonlinearParameters
from exoid.regression.diagnostics import (
    Collinearity,
    JointNoise,
    condition_number,
    describe_noise,
    parameter_scale,
    reference_scale,
    short_runs,
)
from exoid.regression.fit import samples_left, uncertainty_of
from exoid.regression.least_squares import rms_residual, stack
from exoid.signals import Preparation
from exoid.torques import TorqueModel
from exoid.torques.contacts.stretches import Stretch
from exoid.torques.contacts.support_model import LOOP, SupportModel

from .checkup import fitted_leg, logs_apart
from .estimators import Estimator
from .estimators.by_name import name_of
from .findings.checkup import check_fit
from .findings.physics import impossible_leg, mass_scale, unbalanced, with_negative
from .friction_form import doubt_in_the_air, doubt_on_ground
from .ground_faults import unlike_logs
from .group_rows import Group
from .groups import shared_agreement, with_causes
from .problem import Fitted
from .row_changes import torque_findings


@dataclass(frozen=True, eq=False)
class Result:
    """A fit with what its residuals say."""

    fitted: Fitted  # the fit
    estimator: Estimator  # its estimator
    cutoff_source: str  # how the cut-off was chosen
    white: bool  # whether the covariance assumes white noise
    covariance: FloatArray  # covariance of all parameters, (P, P)
    dofs: FloatArray  # degrees of freedom of each parameter's variance, (P,)
    samples: FloatArray  # independent samples of each group of the problem, (G,)
    left: FloatArray  # the same less parameters, (G,)
    reference: FloatArray  # smallest reference scale that any group has for each parameter, (P,)
    noise: tuple[JointNoise, ...]  # noise of the residuals of each joint, group by group
    collinearity: Collinearity  # parameters that the rows can hardly tell apart
    nonlinear: NonlinearParameters  # constants of drives with their covariance
    inputs: tuple[Input, ...]  # all recordings: the errors of every group come from all of them
    warnings: tuple[str, ...]  # warnings of the fit as a whole

    @classmethod
    def of(cls, fitted: Fitted, estimator: Estimator, cutoff_source: str, *, white: bool) -> Result:
        """Find noise and covariance of a fit, and what stands behind its values."""
        problem, fit, solution = fitted.problem, fitted.fit, fitted.fit.solution
        found = uncertainty_of(problem, fit, white=white)
        covariance = found.covariance if fitted.doubt is None else found.covariance + fitted.doubt
        noise = describe_noise(problem, fit, found.noises)
        joints = [name for group in problem.groups for name in group.model.row_names]
        of_groups = [slice(*pair) for pair in pairwise(problem.starts[1])]
        rows = [stack(problem.r_factors[part], fit.weights[part]) for part in of_groups]
        free = int(np.isnan(problem.prior_knowledge.fixed_values(problem.names)).sum())
        if white:
            samples = np.array([sum(each.samples for each in group.r_factors) for group in problem.groups])
            samples = samples * (solution.dof + free) / samples.sum()
        else:
            starts = problem.starts[0, :-1]
            samples = np.add.reduceat(np.array([joint.effective_samples for joint in noise]), starts)
        left, left_each = samples_left(rows, solution.inverse, samples.tolist(), free)
        summaries = {group.name: group.summaries for group in problem.groups}
        inputs = [one.evidence for of_group in summaries.values() for one in of_group]
        standing = problem.groups[0].links is not None
        collinearity, nonlinear = Collinearity.of(solution), fitted.nonlinear
        if nonlinear is not NO_NONLINEAR_PARAMETERS:
            count = len(fitted.models[0].names)
            places = [nonlinear.names.index(name) for name in problem.names[count:]]
            whole = np.zeros((len(nonlinear),) * 2)  # zero for those that are held
            whole[np.ix_(places, places)] = covariance[count:, count:]
            nonlinear = replace(nonlinear, covariance=whole)
        short = () if white else short_runs(found.noises, joints)
        return cls(
            fitted=fitted,
            estimator=estimator,
            cutoff_source=cutoff_source,
            white=white,
            covariance=covariance,
            dofs=left_each if found.dofs is None else np.clip(found.dofs, 1.0, left_each),
            samples=samples,
            left=left,
            reference=_reference_scale(fitted),
            noise=noise,
            collinearity=collinearity,
            nonlinear=nonlinear,
            inputs=tuple(dict.fromkeys(inputs)) if standing else tuple(inputs),
            warnings=(*fitted.warnings, *collinearity.warnings(problem.names), *short),
        )

    def estimate(self, group: int, common: tuple[str, ...]) -> Estimate:
        """Make the estimate of one group, its covariance the group's block of the whole."""
        problem, fit = self.fitted.problem, self.fitted.fit
        layout, solution = problem.layout, fit.solution
        names, parts = layout.names_of(group), problem.parts(layout.groups[group])
        first, rows, standing = parts[0], problem.groups[parts[0]], problem.groups[parts[0]].links is not None
        model = self.fitted.models[first]
        if standing:  # of the leg, whatever rests on the ground
            model = TorqueModel(model.leg, model.terms, model.rigid, model.regrouped, model.separate)
        every, values, several = layout.places[group], self.fitted.values(first), len(layout.groups) > 1
        places = every[: len(values)]  # constants of drives stand behind the others
        covariance = self.covariance[np.ix_(places, places)]
        supports = tuple(_support(problem.groups[k], self.fitted.values(k)) for k in parts) if standing else ()
        main, residual_rms = rows, np.array([rms_residual(each, solution.values[every]) for each in rows.by_row])
        if standing:
            main, residual_rms = _at_one_cutoff(model.leg.joint_names, [problem.groups[k] for k in parts], supports)
        factors = [each for one in self._ordinary(parts) for each in one.r_factors]
        assert main.preparation is not None
        return Estimate(
            model=model,
            values=values,
            covariance=covariance,
            condition_number=condition_number(solution.inverse, every) if several else solution.condition_number,
            dof=float(self.left[parts].sum()),
            residual_rms=residual_rms,
            estimator=fit.name or name_of(self.estimator),
            preparation=main.preparation,
            inputs=self.inputs,
            warnings=common,
            nonlinear=self.nonlinear,
            prior_knowledge=layout.known_by(group, problem.prior_knowledge),
            findings=ordered((*rows.findings, *(self.fitted.findings if first == 0 else ()))),  # said once
            torque_delays=np.zeros(len(model.leg.joint_names)) if rows.delays is None else rows.delays,
            actuators=rows.actuators,
            evidence=Evidence(
                dof_each=self.dofs[places],
                parameter_scale=parameter_scale(factors)[: len(values)],
                reference_scale=self.reference[places],
                collinearity=self.collinearity.indices[places],
                noise=None if standing else self.noise[slice(*problem.starts[0, first : first + 2])],
                cutoff_source=self.cutoff_source,
                supports=supports,
                bounded=tuple(names[problem.names[k]] for k in solution.bounded if problem.names[k] in names),
            ),
        )

    def checked(self, estimate: Estimate, group: int) -> Estimate:
        """Add the faults of logs and model that the rows of one group show."""
        problem, fitted = self.fitted.problem, self.fitted
        parts = problem.parts(problem.layout.groups[group])
        if problem.groups[parts[0]].links is None:
            leg = fitted_leg(fitted, parts[0], estimate.covariance)
            checkup = check_fit(leg)
            doubt = doubt_in_the_air(leg, checkup, estimate.residual_rms, estimate.noise)
            evidence = replace(estimate.evidence, ranges=checkup.ranges, torque_spread=checkup.torque_spread)
            rows = problem.groups[parts[0]]
            passive = unbalanced(rows.model, rows.by_row, fitted.fit.solution.values[problem.places[parts[0]]])
            apart = logs_apart(rows, fitted.values(parts[0]))
            findings = ordered((*estimate.findings, *checkup.findings, *passive, *apart))
            error = None if doubt is None else doubt.model_error()
            return replace(estimate, findings=findings, model_error=error, evidence=evidence)
        values, groups = estimate.values, self._ordinary(parts)
        found = [*torque_findings(fitted, parts), *mass_scale(estimate.model.leg, values, estimate.names)]
        found += unlike_logs(fitted, scaled=False) if group == 0 else ()
        tables = [each.R for one in groups for each in one.r_factors]
        found += impossible_leg(estimate.model.leg, values, estimate.covariance, tables)
        resting = [(one.model.links, one.motions) for one in groups if isinstance(one.model, SupportModel)]
        stretches = [Stretch(links, (), recording) for links, motions in resting for recording in motions]
        found += cone_findings(estimate, stretches)
        doubt, ranges = doubt_on_ground(fitted, parts, self.noise)
        found += doubt.findings(estimate.joint_names, estimate.names, 2.0 * estimate.std)
        findings, evidence = ordered((*estimate.findings, *found)), replace(estimate.evidence, ranges=ranges)
        return replace(estimate, findings=findings, model_error=doubt.model_error(), evidence=evidence)

    def _ordinary(self, parts: Sequence[int]) -> list[Group]:
        """Groups of rows but those that force plates add: differences of large torques, which no parameter explains."""
        groups = [self.fitted.problem.groups[k] for k in parts]
        return [one for one in groups if not (isinstance(one.model, SupportModel) and one.model.plates)]

    def grouped(self, *, check: bool) -> GroupedEstimate:
        """Make the estimates of all groups."""
        problem, solution, layout = self.fitted.problem, self.fitted.fit.solution, self.fitted.problem.layout
        samples = [sum(float(self.samples[k]) for k in problem.parts(name)) for name in layout.groups]
        agreement, disagreed, untested = shared_agreement(problem, self.estimator, samples, white=self.white)
        common = (*self.warnings, *disagreed)
        estimates = {name: self.estimate(k, common) for k, name in enumerate(layout.groups)}
        if check:
            estimates = with_causes({name: self.checked(one, k) for k, (name, one) in enumerate(estimates.items())})
        estimates = {name: with_negative(one) for name, one in estimates.items()}
        own = {name: [layout.place(name, k) for k in range(len(layout.groups))] for name in layout.own}
        apart = set(problem.names if len(layout.groups) < 2 else layout.own)
        also = ", and so the same in all groups"
        notes = [f"{one}{'' if {*one.into} <= apart else also}" for one in self.fitted.models[0].regrouped]
        return GroupedEstimate(
            estimates=estimates,
            layout=layout,
            values=solution.values,
            covariance=self.covariance,
            evidence=Evidence(
                dof_each=self.dofs,
                parameter_scale=parameter_scale(problem.r_factors),
                reference_scale=self.reference,
                collinearity=self.collinearity.indices,
                bounded=tuple(problem.names[k] for k in solution.bounded),
            ),
            dof=float(self.left.sum()),
            condition_number=solution.condition_number,
            prior_knowledge=problem.prior_knowledge,
            equal=equality_of(own, solution.values, self.covariance, self.dofs),
            agreement=agreement,
            warnings=common,
            notes=(*notes, *untested),
        )


def _reference_scale(fitted: Fitted) -> FloatArray:
    """Parameters that would explain all torque of a calm exercise alone, the smallest of any group, (P,)."""
    problem, smallest = fitted.problem, np.full(len(fitted.problem.names), np.inf)
    for k, (group, model) in enumerate(zip(problem.groups, fitted.models, strict=True)):
        lowest = np.min([one.lowest for one in group.summaries], axis=0)
        highest = np.max([one.highest for one in group.summaries], axis=0)
        found = reference_scale(model.loaded_by(fitted.values(k)), lowest, highest, group.r_factors)
        places = problem.places[k][: len(found)]
        smallest[places] = np.minimum(smallest[places], found)
    return smallest


def _support(group: Group, values: FloatArray) -> Support:
    """Describe the rows of one set of links that rest."""
    rms = [rms_residual(of_row, values) for of_row in group.by_row]
    seconds = sum(float(np.count_nonzero(one.mask)) / one.sample_rate for one in group.motions if one.mask is not None)
    return Support(group.links or "", seconds, dict(zip(group.model.row_names, rms, strict=True)))


def _at_one_cutoff(
    joints: Sequence[str], groups: Sequence[Group], supports: Sequence[Support]
) -> tuple[Group, FloatArray]:
    """Choose rows of feet without plates, for the longest time, the most of them; and residuals at their cut-off."""
    # RMS residual of the rows of a joint, or else of closed chains, whose rows have the noise of one torque

    def rank(k: int) -> tuple[bool, float, int, str]:
        model = groups[k].model
        links = model.links if isinstance(model, SupportModel) and not model.plates else ()
        return bool(links), round(supports[k].seconds, 6), len(links), supports[k].name  # whatever the order of logs

    main = groups[max(range(len(groups)), key=rank)]
    shares = [cast(Preparation, x.preparation).independent_fraction(x.motions[0].sample_rate) for x in (main, *groups)]
    of_rows = defaultdict[str, list[tuple[float, float]]](list)  # mean squares, of white noise, and seconds
    for one, share in zip(supports, shares[1:], strict=True):
        for row, rms in one.residual_rms.items():
            of_rows[LOOP if row.startswith(LOOP) else row].append((shares[0] / share * rms**2, one.seconds))
    squares = [np.array(of_rows.get(joint) or of_rows.get(LOOP) or [(0.0, 1.0)]).T for joint in joints]
    return main, np.array([math.sqrt(np.average(mean, weights=seconds)) for mean, seconds in squares])
