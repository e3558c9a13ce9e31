"""Several groups of recordings, such as sessions or legs, that are identified together: do they belong together?"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import scipy  # its parts load when they are first used

from exoid.errors import BadArgumentError, ExoidError, within
from exoid.estimate.comparison import Equality, equality_of
from exoid.estimate.estimate import Estimate
from exoid.leg.leg import Leg
from exoid.regression.fit import uncertainty_of
from exoid.regression.parameters import PriorKnowledge
from exoid.signals import Poses, Recording, Recordings
from exoid.signals.recordings import RecordingFile

from .estimators import Estimator
from .estimators.by_name import fit_linear
from .group_rows import Data, Group, Measured, check_recordings
from .problem import Problem


def pair_groups(
    legs: Leg | Mapping[str, Leg], recordings: Measured | Mapping[str, Measured], own: str | Sequence[str] | None
) -> dict[str, tuple[Leg, Data]]:
    """Bring legs and recordings together by the names of the groups; a recording without a name has a number."""
    if own is None and not isinstance(recordings, Mapping):
        what = "legs have names, recordings have none"
        raise BadArgumentError(what, remedy='name both: {"left": leg}, {"left": log}')
    named = recordings if isinstance(recordings, Mapping) else _by_source(check_recordings(recordings))
    if not named:
        raise BadArgumentError("no recordings", remedy='pass groups such as {"left": [...], "right": [...]}')
    if isinstance(legs, Mapping) and set(legs) != set(named):
        what = f"legs are of {', '.join(legs)}, recordings of {', '.join(named)}"
        raise BadArgumentError(what, remedy="use the same names for both")
    if len({str(name) for name in named}) < len(named):
        what = f"two groups have the same name: {', '.join(map(str, named))}"
        raise BadArgumentError(what, remedy="name them otherwise")
    pairs = {}
    for name, data in named.items():
        with within(name):
            pairs[str(name)] = legs[name] if isinstance(legs, Mapping) else legs, check_recordings(data)
    return pairs


def _by_source(recordings: Data) -> dict[str, Sequence[Recording | Poses]]:
    """Make a group of each recording, named after its file; one on disk is not read for it."""
    named: dict[str, Sequence[Recording | Poses]] = {}
    for index in range(len(recordings)):
        item = recordings.items[index] if isinstance(recordings, Recordings) else None
        file_name = item.path.name if isinstance(item, RecordingFile) else recordings[index].file_name
        name = file_name or str(index + 1)
        if name in named:
            raise BadArgumentError(f"two recordings are called {name}", remedy='name them: {"monday": a, "tuesday": b}')
        named[name] = recordings[index : index + 1]
    return named


def own_parameters(groups: Sequence[Group], own: str | Sequence[str] | None) -> tuple[str, ...]:
    """Look up the names of the parameters that each group has of its own."""
    if own is None and [group.name for group in groups] == [""]:
        return ()
    model = groups[0].model
    for other in groups[1:]:
        if other.model.names != model.names or other.model.units != model.units:
            first, second = (", ".join(one.names) for one in (model, other.model))
            what = f"parameters of {groups[0].name} are {first}, those of {other.name} {second}"
            remedy = "identify legs of one design, with the same joints, together"
            raise BadArgumentError(what, remedy=remedy)
    rigid = model.leg.parameter_names
    own = [name for name in model.names if name not in rigid] if own is None else own
    asked = (own,) if isinstance(own, str) else tuple(own)
    symbols: dict[str, set[str]] = {}
    for block in model.blocks:
        for symbol, name in zip(block.term.symbols, block.names, strict=True):
            symbols.setdefault(symbol, set()).add(name)
    for name in asked:
        if name not in symbols and name not in model.every_name:
            known = ", ".join((*symbols, *model.every_name))
            raise BadArgumentError(f"no parameter {name!r} to be each group's own", remedy=f"name some of {known}")
    for regrouped in model.regrouped:
        if regrouped.name in asked:
            raise BadArgumentError(f"{regrouped}", remedy=f"name {' and '.join(regrouped.into)} as own instead")
    wanted = {name for given in asked for name in symbols.get(given, {given})}
    if not set(rigid) <= wanted:  # those that are shared have to mean the same: regressors are equal but for rounding
        motion = np.random.default_rng(0).standard_normal((3, 10, len(model.leg.joint_names)))
        expected = model.leg.regressor(*motion)
        for other in groups[1:]:
            if np.abs(other.model.leg.regressor(*motion) - expected).max() > 1e-9 * np.abs(expected).max():
                what = f"legs of {groups[0].name} and {other.name} are not of one design: lengths or axes differ"
                raise BadArgumentError(what, remedy="identify them one by one")
    return tuple(name for name in model.names if name in wanted)


def shared_agreement(
    problem: Problem, estimator: Estimator, samples: Sequence[float], *, white: bool
) -> tuple[Equality | None, tuple[str, ...], tuple[str, ...]]:
    """Identify each group alone, without priors and bounds, and test whether shared parameters are the same."""
    # the test, None where there is none; a warning of parameters that are not; and a note of why there is no test
    layout, groups = problem.layout, problem.layout.groups
    if len(groups) < 2 or not layout.shared:
        return None, (), ()
    values, blocks, dofs = [], [], []
    for index, (group, count) in enumerate(zip(groups, samples, strict=True)):
        known = layout.known_by(index, problem.prior_knowledge).known
        alone = Problem(tuple(problem.groups[k] for k in problem.parts(group)), (), PriorKnowledge(known))
        try:
            fit = fit_linear(alone, estimator).fit
        except ExoidError as error:
            why = f"{group} cannot be identified alone ({error.what})"
            return None, (), (f"whether groups agree on what they share was not tested: {why}",)
        found = uncertainty_of(alone, fit, white=white)
        values.append(fit.solution.values)
        blocks.append(found.covariance)
        left = np.full(len(alone.names), max(1.0, count - len(alone.names)))
        dofs.append(left if found.dofs is None else np.clip(found.dofs, 1.0, left))
    names = problem.groups[0].model.names
    shared = [name for name in layout.names[: layout.shared] if name not in problem.prior_knowledge.known]
    places = {name: [k * len(names) + names.index(name) for k in range(len(groups))] for name in shared}
    covariance = scipy.linalg.block_diag(*blocks)
    equality = equality_of(places, np.concatenate(values), covariance, np.concatenate(dofs))
    below = ", ".join(equality.below(0.01))  # in 1 % of groups that do share their parameters
    warning = f"groups do not agree on {below} by more than noise explains: make these own, or find what differs"
    return equality, (warning,) if below else (), ()


def with_causes(estimates: Mapping[str, Estimate]) -> dict[str, Estimate]:
    """Let large residuals of a group without errors of its own name those of others, which bend what all share."""
    effects, told = {"large-residual", "unmodelled-friction", "impossible-leg"}, dict(estimates)
    every = [(name, one) for name, estimate in estimates.items() for one in estimate.findings]
    errors = {name: one.kind for name, one in every if one.severity == "error" and one.kind not in effects}
    causes = " and ".join(f"{kind} of {name}" for name, kind in errors.items())
    for name in estimates.keys() - errors.keys() if errors else ():
        more = f"; mend {causes} first, which bends what the groups share"
        said = (replace(x, message=x.message + more * (x.kind == "large-residual")) for x in told[name].findings)
        told[name] = replace(told[name], findings=tuple(said))
    return told
