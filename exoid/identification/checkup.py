"""Checks of the logs of a fit: faults that would otherwise pass in silence, and delays that are taken out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from exoid._typing import FloatArray
from exoid.actuators import Actuators
from exoid.estimate.finding import Finding
from exoid.estimate.model_error import ModelError
from exoid.regression.diagnostics import JointNoise
from exoid.regression.rows import for_leg
from exoid.signals import Poses, without_torque_delay
from exoid.torques import TorqueModel

from .findings.arms import arm_shapes
from .findings.checkup import Checkup, check_fit
from .findings.sample import FittedLeg, few_of
from .findings.search import delays, find_faults
from .fitting import Fitted, Task
from .friction_form import friction_form_error, friction_rows
from .group_rows import Group


def check_group(fitted: Fitted, group: int, covariance: FloatArray, actuators: Actuators | None = None) -> Checkup:
    """Check the logs of one group, and the fit to them."""
    leg = _fitted_leg(fitted, group, covariance)
    return check_fit(leg if actuators is None else leg._replace(arms=arm_shapes(actuators, leg.model.leg)))


def model_error(
    fitted: Fitted,
    group: int,
    checkup: Checkup,
    residual_rms: FloatArray,
    noise: Sequence[JointNoise],
) -> ModelError | None:
    """Estimate how far friction of another form may move the torques that one group's estimate predicts."""
    if checkup.ranges is None:
        return None
    speed, leg = checkup.ranges.speed, _fitted_leg(fitted, group)
    share = np.array([joint.effective_samples / max(joint.samples, 1) for joint in noise])
    rows = friction_rows(leg, speed) if checkup.friction is None else checkup.friction
    return friction_form_error(leg, speed, residual_rms, share, rows)


def without_delays(task: Task, fitted: Fitted) -> Task:
    """Estimate by how much torques are late, and shift them."""
    groups, found, shifts = [], [], []
    for k, group in enumerate(task.groups):
        leg = _fitted_leg(fitted, k)
        late, half = delays(find_faults(leg._replace(data=few_of(leg.data)).sampled()), len(leg.model.joint_names))
        groups.append(_shifted(group, late) if late.any() else group)
        found.append(late)
        each = zip(group.leg.joint_names, late, half, strict=True)
        shifts.append(tuple(_shift_finding(joint, delay, error) for joint, delay, error in each if delay))
    return task._replace(groups=tuple(groups), delays=tuple(found)).with_findings(shifts)


def _shifted(group: Group, delays: FloatArray) -> Group:
    """Shift the torques of a group."""
    model = TorqueModel.at_start(group.leg, ())
    by_joint = {k: float(delay) for k, delay in enumerate(delays) if delay}
    chosen = (for_leg(model, one) for one in group.data)
    data = [one if isinstance(one, Poses) else without_torque_delay(one, by_joint) for one in chosen]
    return group._replace(data=data)


def _shift_finding(joint: str, delay: float, half: float) -> Finding:
    """Say that a torque was shifted."""
    message = (
        f"the torque of {joint} came {1e3 * abs(delay):.3g} ms {'after' if delay > 0.0 else 'before'} the motion, "
        "and was shifted by that"
    )
    remedy = "correct the time stamps of the log; validation shifts its torques by the same"
    return Finding(
        "torque-delay",
        joint,
        float(delay),
        "s",
        "info",
        message,
        remedy,
        interval=(float(delay - half), float(delay + half)),
    )


def _fitted_leg(fitted: Fitted, group: int, covariance: FloatArray | None = None) -> FittedLeg:
    """Gather what a check of one group needs."""
    model, problem = fitted.models[group], fitted.problem
    rows = problem.groups[group]
    names = problem.layout.names_of(group)
    known = problem.layout.known_by(group, problem.prior_knowledge).known
    held = {names[problem.names[k]]: 0.0 for k in fitted.fit.solution.bounded if problem.names[k] in names}
    fixed = np.array([{**known, **held}.get(name, np.nan) for name in model.names])
    values = fitted.values[problem.layout.places[group][: len(model.names)]]
    errors = np.zeros((len(model.names),) * 2) if covariance is None else covariance
    return FittedLeg(model, rows.data, rows.preparation, fixed, values, errors)
