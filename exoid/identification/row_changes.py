"""What changes rows, found beside the parameters: compliance of soles, and delays of torques on the ground."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.regression.least_squares import scaled_inverse
from exoid.regression.row_data import Rows
from exoid.regression.rows import for_leg
from exoid.signals import Poses, Recording, without_torque_delay
from exoid.torques.contacts.standing_base import StandingBase, standing_base

from .group_rows import Group
from .problem import Fitted, Problem

TILT, DELAY = (
    5e-5,
    2e-3,
)  # compliance [rad/(N·m)], of a sole of 20 kN·m/rad, and delay [s] at which effects are computed


class RowChanges(NamedTuple):
    """Numbers c that change rows, r(c) = r − D c, found beside the parameters."""

    values: FloatArray  # c, (K,)
    covariance: FloatArray  # its covariance for white noise, (K, K)
    slopes: FloatArray  # change of the parameters by c, ∂β/∂c, (P, K)


def sole_compliance(fitted: Fitted) -> tuple[tuple[str, ...], RowChanges]:
    """Find the compliance θ = c τ of soles [rad/(N·m)], for each foot that carries a base that was not measured."""
    problem = fitted.problem
    data = (one for group in problem.groups for one in group.data if isinstance(one, Recording))
    links = tuple(dict.fromkeys(one.base.link for one in data if isinstance(one.base, StandingBase)))
    if not links:
        return links, RowChanges(np.zeros(0), np.zeros((0, 0)), np.zeros((len(problem.names), 0)))
    # Standard deviation of the compliance before any log is seen [rad/(N·m)]: a sole of 10 kN·m/rad is soft
    found = row_changes(fitted, [tilted(problem, {link: TILT}) for link in links], TILT, prior_std=1e-4)
    values = np.maximum(found.values, 0.0)
    # Part of itself by which a compliance varies: soles are stiffer under more load
    doubt = (0.2 * values) ** 2 + (found.values - values) ** 2
    return links, RowChanges(values, found.covariance + np.diag(doubt), found.slopes)


def torque_delays(fitted: Fitted, parts: Sequence[int]) -> tuple[FloatArray, FloatArray]:
    """Find delays of torques of some groups [s], 0 where none is significant, and half widths of their intervals."""
    problem, joints = fitted.problem, fitted.models[parts[0]].joint_names
    late = [_late(problem, parts, joint) for joint in range(len(joints))]
    found = row_changes(fitted, late, DELAY, prior_std=0.1)
    # Residuals are correlated: rows count by a third. On 60 machines without delay, of 80 values none was beyond 4.5
    # standard deviations for white noise; of 18 torques that were 40 ms late, 16 were beyond 7.
    half = 2.0 * np.sqrt(3.0 * np.diag(found.covariance))
    # A torque that is shifted by less than a fifth of a millisecond is as good as on time
    significant = (np.abs(found.values) > 1.5 * half) & (np.abs(found.values) > 2e-4)
    return np.where(significant, found.values, 0.0), half


def row_changes(fitted: Fitted, others: Sequence[Problem], step: float, *, prior_std: float) -> RowChanges:
    """Find numbers c beside the parameters, given problems in which one of them has the size of a step."""
    # Least squares of r = W δβ + D c with c ~ N(0, σ²), D by a difference, gives c and its covariance, and
    # ∂β/∂c = −(WᵀW)⁻¹ WᵀD.
    problem, count, more = fitted.problem, len(fitted.problem.names), len(others)
    information, right = np.zeros((count + more,) * 2), np.zeros(count + more)
    for k, group in enumerate(problem.groups):
        # without poses, R factors are counted as rows are
        weights = np.array(fitted.fit.weights[slice(*problem.starts[0, k : k + 2])])
        values, where = fitted.values(k), np.append(problem.places[k], count + np.arange(more))
        every = (group.blocks(decimated=True), *(other.groups[k].blocks(decimated=True) for other in others))
        for blocks in zip(*every, strict=True):
            first, usable = _residual(blocks[0].rows, values), blocks[0].rows.usable[..., None]
            slopes = [(first - _residual(block.rows, values)) / step for block in blocks[1:]]
            columns = [np.where(usable, blocks[0].rows.W, 0.0), np.stack(slopes, axis=-1)]
            weighted = (np.concatenate(columns, axis=-1) * weights[:, None]).reshape(-1, len(where))
            information[np.ix_(where, where)] += weighted.T @ weighted
            right[where] += weighted.T @ (first * weights).ravel()
    free = np.append(problem.prior_knowledge.free(problem.names), np.ones(more, dtype=np.bool_))
    free[list(fitted.fit.solution.bounded)] = False
    prior = np.diag(np.append(np.zeros(count), np.full(more, prior_std**-2)))
    known = (information + prior)[np.ix_(free, free)]
    inverse = scaled_inverse(known)
    own, slopes_of = np.flatnonzero(free[:count]), np.zeros((count, more))
    slopes_of[own] = -scaled_inverse(known[: len(own), : len(own)]) @ information[own, count:]
    return RowChanges((inverse @ right[free])[-more:], inverse[-more:, -more:], slopes_of)


def tilted(problem: Problem, compliance: Mapping[str, float]) -> Problem:
    """Let the feet that carry the base tilt."""
    groups = []
    for group in problem.groups:
        data = [
            replace(one, base=standing_base(group.model.leg, one, one.base.link, compliance.get(one.base.link, 0.0)))
            if isinstance(one, Recording) and isinstance(one.base, StandingBase)
            else one
            for one in group.data
        ]
        groups.append(replace(group, data=tuple(data)))
    return replace(problem, groups=tuple(groups))


def _late(problem: Problem, parts: Sequence[int], joint: int) -> Problem:
    """Shift the torque of one joint of some groups by a step."""
    groups: list[Group] = list(problem.groups)
    for k in parts:
        chosen = (for_leg(groups[k].model, one) for one in groups[k].data)
        data = [one if isinstance(one, Poses) else without_torque_delay(one, {joint: DELAY}) for one in chosen]
        groups[k] = replace(groups[k], data=data)
    return replace(problem, groups=tuple(groups))


def _residual(rows: Rows, values: FloatArray) -> FloatArray:
    """Residuals of usable rows, (N, R)."""
    return np.where(rows.usable, rows.tau - rows.W @ values, 0.0)
