"""Compliance of soles: a foot that carries the base tilts under the torque of its joint, where no IMU says so."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.estimate.finding import Finding
from exoid.regression.least_squares import scaled_inverse
from exoid.regression.row_data import Rows
from exoid.signals import Recording
from exoid.torques.contacts.standing_base import StandingBase, standing_base

from .fitting import Fitted, Task
from .group_rows import Group
from .problem import Problem

STEP = 5e-5
"""Compliance at which its effect is computed [rad/(N·m)]: a sole of 20 kN·m/rad."""


class SoleCompliance(NamedTuple):
    """Compliance c of the soles of feet that carry the base, θ = c τ, found beside the parameters."""

    links: tuple[str, ...]  # feet
    values: FloatArray  # compliance of each [rad/(N·m)], (K,)
    covariance: FloatArray  # its covariance, (K, K)
    slopes: FloatArray  # change of the parameters by the compliances, ∂β/∂c, (P, K)

    @property
    def of_parameters(self) -> FloatArray:
        """Covariance that the errors of the compliances add to that of the parameters, (P, P)."""
        return np.asarray(self.slopes @ self.covariance @ self.slopes.T)

    def findings(self) -> tuple[Finding, ...]:
        """Say how soft the soles are."""
        std = np.sqrt(np.diag(self.covariance))
        return tuple(
            Finding(
                "sole-compliance",
                "",
                float(value),
                "rad/(N·m)",
                "info",
                f"the motion of the base follows from {link}, which tilts by {value:.2g} ± {2.0 * error:.2g} rad/(N·m) "
                "under the torque of its joint; this was taken into account, and its error is part of all intervals",
                "record an IMU on the torso, which needs no such assumption",
                interval=(float(value - 2.0 * error), float(value + 2.0 * error)),
            )
            for link, value, error in zip(self.links, self.values, std, strict=True)
        )


def sole_compliance(task: Task, fitted: Fitted) -> SoleCompliance | None:
    """Find the compliance of soles beside the parameters."""
    # Rows depend on c by the motion of the base, r(c) = r − D c, with D by a difference. Least squares of
    # r = W δβ + D c with c ~ N(0, σ²) gives c and its covariance; ∂β/∂c = −(WᵀW)⁻¹ WᵀD.
    links = tuple(dict.fromkeys(base.link for group in task.groups for base in _bases(group)))
    if not links:
        return None
    others = [_problem(tilted(task, {link: STEP})) for link in links]
    count, information = len(fitted.values), np.zeros((len(fitted.values) + len(links),) * 2)
    right = np.zeros(len(information))
    for k, group in enumerate(fitted.problem.groups):
        weights = np.array(fitted.fit.weights[slice(*fitted.problem.joints_of(k))])
        every = (group.blocks(decimated=True), *(other.groups[k].blocks(decimated=True) for other in others))
        for blocks in zip(*every, strict=True):
            first = _residual(blocks[0].rows, fitted.values)
            slopes = [(first - _residual(block.rows, fitted.values)) / STEP for block in blocks[1:]]
            columns = [np.where(blocks[0].rows.usable[..., None], blocks[0].rows.W, 0.0), np.stack(slopes, axis=-1)]
            weighted = (np.concatenate(columns, axis=-1) * weights[:, None]).reshape(-1, len(information))
            information += weighted.T @ weighted
            right += weighted.T @ (first * weights).ravel()
    free = np.append(_free(fitted), np.ones(len(links), dtype=np.bool_))
    # Standard deviation of the compliance before any log is seen [rad/(N·m)]: a sole of 10 kN·m/rad is soft
    prior = np.diag(np.append(np.zeros(count), np.full(len(links), 1e-4**-2)))
    known = (information + prior)[np.ix_(free, free)]
    inverse = scaled_inverse(known)
    found = (inverse @ right[free])[-len(links) :]
    values = np.maximum(found, 0.0)
    # Part of itself by which a compliance varies: soles are stiffer under more load
    doubt = (0.2 * values) ** 2 + (found - values) ** 2
    own, slopes_of = np.flatnonzero(free[:count]), np.zeros((count, len(links)))
    slopes_of[own] = -scaled_inverse(known[: len(own), : len(own)]) @ information[own, count:]
    covariance = inverse[-len(links) :, -len(links) :] + np.diag(doubt)
    return SoleCompliance(links, values, covariance, slopes_of)


def tilted(task: Task, compliance: Mapping[str, float]) -> Task:
    """Let the feet that carry the base tilt."""
    return task._replace(groups=tuple(_tilted(task, k, compliance) for k in range(len(task.groups))))


def _tilted(task: Task, index: int, compliance: Mapping[str, float]) -> Group:
    """Let the feet of one group tilt."""
    group, leg = task.groups[index], task.models[index].leg
    data = [
        replace(one, base=standing_base(leg, one, one.base.link, compliance.get(one.base.link, 0.0)))
        if isinstance(one, Recording) and isinstance(one.base, StandingBase)
        else one
        for one in group.data
    ]
    return group._replace(data=tuple(data))


def _bases(group: Group) -> list[StandingBase]:
    """Motions of the base that feet say."""
    bases = [one.base for one in group.data if isinstance(one, Recording)]
    return [base for base in bases if isinstance(base, StandingBase)]


def _problem(task: Task) -> Problem:
    """Form the rows of a task."""
    return Problem.of(task.groups, task.models, task.own, task.prior_knowledge, task.keep)


def _residual(rows: Rows, values: FloatArray) -> FloatArray:
    """Residuals of usable rows, (N, R)."""
    return np.where(rows.usable, rows.tau - rows.W @ values, 0.0)


def _free(fitted: Fitted) -> NDArray[np.bool_]:
    """Which parameters a change of the rows can move, (P,)."""
    free = np.asarray(fitted.problem.prior_knowledge.free(fitted.problem.names), dtype=np.bool_).copy()
    free[list(fitted.fit.solution.bounded)] = False
    return free
