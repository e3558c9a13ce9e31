"""Task, start and result of a fit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from exoid._typing import FloatArray
from exoid.actuators import Actuators
from exoid.estimate.finding import Finding, ordered
from exoid.estimate.nonlinear import NonlinearParameters
from exoid.regression.fit import Fit
from exoid.regression.parameters import NO_PRIOR_KNOWLEDGE, PriorKnowledge
from exoid.torques import Term, TorqueModel

from .estimators import Estimator
from .group_rows import Group, Keep
from .problem import Problem
from .recording_summary import RecordingSummary


class Task(NamedTuple):
    """What is fitted to what and how, and what was mended in the logs before."""

    groups: tuple[Group, ...]  # groups of recordings; one is the usual case
    models: tuple[TorqueModel, ...]  # torque model of each group, nonlinear parameters at their start values
    terms: tuple[Term, ...]  # terms of the models, settings of which may be nonlinear parameters
    estimator: Estimator  # the estimator
    own: tuple[str, ...] = ()  # names of parameters that each group has of its own
    prior_knowledge: PriorKnowledge = NO_PRIOR_KNOWLEDGE  # known parameters, priors and signs
    keep: Keep | None = None  # function that selects rows; None for all
    # drives with unknown constants, which are found beside the parameters; None for none
    unknown: Actuators | None = None
    actuators: tuple[Actuators, ...] = ()  # drives of each group; empty where torques were measured
    summaries: tuple[Sequence[RecordingSummary], ...] = ()  # summaries of the recordings of each group
    findings: tuple[tuple[Finding, ...], ...] = ()  # what was mended in each group; empty for nothing
    # delays that were taken out of the torques of each group [s], (n,) each; empty for none
    delays: tuple[FloatArray, ...] = ()
    cutoff_source: str = ""  # how the cut-off was chosen

    def with_findings(self, findings: Sequence[Sequence[Finding]]) -> Task:
        """Add findings of each group."""
        before = self.findings or ((),) * len(findings)
        return self._replace(findings=tuple((*old, *new) for old, new in zip(before, findings, strict=True)))

    def findings_with(self, group: int, others: tuple[Finding, ...]) -> tuple[Finding, ...]:
        """Add what was mended in a group to other findings."""
        own = self.findings[group] if self.findings else ()
        return ordered((*own, *others)) if own else others


class Fitted(NamedTuple):
    """A fit."""

    models: tuple[TorqueModel, ...]  # torque model of each group with all settings, loaded by the fitted rigid bodies
    values: FloatArray  # β, (P,)
    nonlinear: NonlinearParameters  # nonlinear parameters that were found, without covariance
    problem: Problem  # rows, about the solution linear in β and in the nonlinear parameters that are not held
    fit: Fit  # solution in both
    warnings: tuple[str, ...]  # warnings for the reader


class Start(NamedTuple):
    """Where a fit begins."""

    values: FloatArray  # β, (P,)
    settings: dict[str, float]  # θ by name
    weights: Sequence[float]  # weights of the R factors

    @staticmethod
    def at(fitted: Fitted) -> Start:
        """Begin where a fit has ended."""
        nonlinear = fitted.nonlinear
        settings = dict(zip(nonlinear.names, nonlinear.values.tolist(), strict=True))
        return Start(fitted.values, settings, fitted.fit.weights)
