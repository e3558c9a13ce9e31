"""Whether groups have the same parameters: those of their own, and those that they are made to share."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid.errors import ExoidError
from exoid.estimate.comparison import Equality, equality_of
from exoid.regression.fit import uncertainty_of
from exoid.regression.parameters import PriorKnowledge

from .estimators import Estimator
from .estimators.by_name import fit_by
from .problem import Problem


class Agreement(NamedTuple):
    """Whether groups, each identified alone, agree on what they share."""

    equality: Equality | None  # the test; None where there is none
    warnings: tuple[str, ...] = ()  # parameters on which they do not agree
    notes: tuple[str, ...] = ()  # why there is no test


def shared_agreement(problem: Problem, estimator: Estimator, samples: Sequence[float], *, white: bool) -> Agreement:
    """Identify each group alone, without priors and bounds, and test whether shared parameters are the same."""
    layout, groups = problem.layout, problem.layout.groups
    if len(groups) < 2 or not layout.shared:
        return Agreement(None)
    values, blocks, dofs = [], [], []
    for index, (group, count) in enumerate(zip(groups, samples, strict=True)):
        known = layout.known_by(index, problem.prior_knowledge).known
        of_group = tuple(rows for rows in problem.groups if rows.name == group)
        alone = Problem(of_group, (), PriorKnowledge(known))
        try:
            fit = fit_by(estimator, alone)
        except ExoidError as error:
            why = f"{group} cannot be identified alone ({error.what})"
            return Agreement(None, notes=(f"whether groups agree on what they share was not tested: {why}",))
        found = uncertainty_of(alone, fit, white=white)
        values.append(fit.solution.values)
        blocks.append(found.covariance)
        left = np.full(len(alone.names), max(1.0, count - len(alone.names)))
        dofs.append(left if found.dofs is None else np.clip(found.dofs, 1.0, left))
    names = problem.groups[0].model.names
    places = {
        name: [group * len(names) + names.index(name) for group in range(len(groups))]
        for name in layout.names[: layout.shared]
        if name not in problem.prior_knowledge.known
    }
    covariance = scipy.linalg.block_diag(*blocks)
    equality = equality_of(places, np.concatenate(values), covariance, np.concatenate(dofs))
    # Probability with which groups that do share their parameters would be said not to
    below = ", ".join(equality.below(0.01))
    warning = (
        f"groups do not agree on {below}, which they share, by more than noise explains: make these own, or find out "
        "what else differs"
    )
    return Agreement(equality, (warning,) if below else ())
