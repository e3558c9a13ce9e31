"""Checks of the logs of a fit: faults that would otherwise pass in silence, and delays that are taken out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from exoid._typing import FloatArray
from exoid.estimate.finding import Finding
from exoid.estimate.model_error import ModelError
from exoid.regression.diagnostics import JointNoise
from exoid.regression.rows import for_leg
from exoid.signals import Poses, without_torque_delay

from .findings.arms import arm_shapes
from .findings.checkup import Checkup, check_fit
from .findings.sample import FittedLeg, few_of
from .findings.search import delays, find_faults
from .friction_form import friction_form_error, friction_rows
from .group_rows import Group
from .problem import Fitted, Problem
from .row_changes import torque_delays


def check_group(
    fitted: Fitted, group: int, covariance: FloatArray, residual_rms: FloatArray, noise: Sequence[JointNoise]
) -> tuple[Checkup, ModelError | None]:
    """Check the logs of one group and the fit to them; and how far friction of another form may move its torques."""
    leg, actuators = _fitted_leg(fitted, group, covariance), fitted.problem.groups[group].actuators
    leg = leg if actuators is None else leg._replace(arms=arm_shapes(actuators, leg.model.leg))
    checkup = check_fit(leg)
    if checkup.ranges is None:
        return checkup, None
    speed = checkup.ranges.speed
    share = np.array([joint.effective_samples / max(joint.samples, 1) for joint in noise])
    rows = friction_rows(leg, speed) if checkup.friction is None else checkup.friction
    return checkup, friction_form_error(leg, speed, residual_rms, share, rows)


def without_delays(problem: Problem, fitted: Fitted) -> Problem:
    """Estimate by how much torques are late, and shift them: of every group of the problem that was fitted."""
    groups = []
    for group in problem.groups:
        parts = [k for k, one in enumerate(fitted.problem.groups) if one.name == group.name]
        if fitted.problem.groups[parts[0]].links is None:
            leg = _fitted_leg(fitted, parts[0])
            late = delays(find_faults(leg._replace(data=few_of(leg.data)).sampled()), len(leg.model.joint_names))
        else:
            late = torque_delays(fitted, parts)
        groups.append(_shifted(group, late) if late[0].any() else group)
    return replace(problem, groups=tuple(groups))


def _shifted(group: Group, late: tuple[FloatArray, FloatArray]) -> Group:
    """Shift the torques of a group, and say so."""
    by_joint, found = {k: float(delay) for k, delay in enumerate(late[0]) if delay}, list(group.findings)
    for joint, delay, half in zip(group.model.joint_names, late[0].tolist(), late[1].tolist(), strict=True):
        if delay:
            message = (
                f"the torque of {joint} came {1e3 * abs(delay):.3g} ms {'after' if delay > 0.0 else 'before'} the "
                "motion, and was shifted by that"
            )
            remedy = "correct the time stamps of the log; validation shifts its torques by the same"
            interval = (delay - half, delay + half)
            found.append(Finding("torque-delay", joint, delay, "s", "info", message, remedy, interval))
    chosen = (for_leg(group.model, one) for one in group.data)
    data = [one if isinstance(one, Poses) else without_torque_delay(one, by_joint) for one in chosen]
    return replace(group, data=data, delays=late[0], findings=tuple(found))


def _fitted_leg(fitted: Fitted, group: int, covariance: FloatArray | None = None) -> FittedLeg:
    """Gather what a check of one group needs."""
    model, problem, rows = fitted.models[group], fitted.problem, fitted.problem.groups[group]
    place = problem.layout.groups.index(rows.name)
    names = problem.layout.names_of(place)
    known = problem.layout.known_by(place, problem.prior_knowledge).known
    held = {names[problem.names[k]]: 0.0 for k in fitted.fit.solution.bounded if problem.names[k] in names}
    fixed = np.array([{**known, **held}.get(name, np.nan) for name in model.names])
    errors = np.zeros((len(model.names),) * 2) if covariance is None else covariance
    assert rows.preparation is not None
    return FittedLeg(model, rows.data, rows.preparation, fixed, fitted.values(group), errors)
