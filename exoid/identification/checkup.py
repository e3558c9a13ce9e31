"""Checks of the logs of a fit: faults that would otherwise pass in silence, and delays that are taken out."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.checks import Checkup, FittedLeg, check_fit, torque_delays, without_delay
from exoid.errors import ExoidError
from exoid.findings import Finding
from exoid.regression.rows import for_leg
from exoid.signals import Cluster, Poses
from exoid.torques import TorqueModel

from .fitting import Fitted, Task
from .group_rows import Group


def check_group(fitted: Fitted, group: int, covariance: FloatArray) -> Checkup:
    """Check the logs of one group, and the fit to them.

    Args:
        fitted: The fit of all groups.
        group: Index of the group.
        covariance: Covariance of the parameters of its model, (P, P).

    Returns:
        Findings and ranges of the motion; nothing for recordings on a cluster.
    """
    data = fitted.problem.groups[group].data
    if isinstance(data, Cluster):
        return Checkup()
    return check_fit(_fitted_leg(fitted, group, covariance), data)


def without_delays(task: Task, fitted: Fitted) -> tuple[Task, tuple[tuple[Finding, ...], ...]]:
    """Estimate by how much torques are late, and shift them.

    Args:
        task: Torque model and data.
        fitted: Fit to the data as they are.

    Returns:
        The task with shifted torques, and findings that say by how much, for each group.

    Raises:
        ExoidError: Recordings are on a cluster.
    """
    groups, shifts = [], []
    for k, group in enumerate(task.groups):
        if isinstance(group.data, Cluster):
            raise ExoidError("delays of recordings on a cluster cannot be corrected", remedy="leave delay out")
        nothing = np.zeros((len(fitted.models[k].names),) * 2)
        delays = torque_delays(_fitted_leg(fitted, k, nothing), group.data)
        groups.append(_shifted(group, delays.values) if delays.values.any() else group)
        each = zip(group.leg.joint_names, delays.values, delays.half, strict=True)
        shifts.append(tuple(_shift_finding(joint, delay, half) for joint, delay, half in each if delay))
    return task._replace(groups=tuple(groups)), tuple(shifts)


def _shifted(group: Group, delays: FloatArray) -> Group:
    """Shift the torques of a group."""
    assert not isinstance(group.data, Cluster)
    model = TorqueModel.at_start(group.leg, ())
    by_joint = {k: float(delay) for k, delay in enumerate(delays) if delay}
    chosen = (for_leg(model, one) for one in group.data)
    data = [one if isinstance(one, Poses) else without_delay(one, by_joint) for one in chosen]
    return group._replace(data=data)


def _shift_finding(joint: str, delay: float, half: float) -> Finding:
    """Say that a torque was shifted."""
    return Finding(
        "torque-delay",
        joint,
        float(delay),
        "s",
        "info",
        f"the torque of {joint} came {1e3 * abs(delay):.3g} ms {'after' if delay > 0.0 else 'before'} the motion, "
        "and was shifted by that",
        "correct the time stamps of the log, so that validation sees the same",
        interval=(float(delay - half), float(delay + half)),
    )


def _fitted_leg(fitted: Fitted, group: int, covariance: FloatArray) -> FittedLeg:
    """Gather what a check of one group needs."""
    model, problem = fitted.models[group], fitted.problem
    names = problem.layout.names_of(group)
    known = problem.layout.known_by(group, problem.prior_knowledge).known
    held = {names[problem.names[k]]: 0.0 for k in fitted.fit.solution.bounded if problem.names[k] in names}
    fixed = np.array([{**known, **held}.get(name, np.nan) for name in model.names])
    values = fitted.values[problem.layout.places[group][: len(model.names)]]
    return FittedLeg(model, problem.groups[group].preparation, fixed, values, covariance)
