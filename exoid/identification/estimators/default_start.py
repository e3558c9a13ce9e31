"""Where iterations begin."""

from __future__ import annotations

from exoid._typing import FloatArray
from exoid.errors import NotSupportedError
from exoid.identification.problem import Problem
from exoid.regression.fit import wls
from exoid.regression.rows import for_leg
from exoid.signals import ZeroPhase, choose_cutoff
from exoid.torques import TorqueModel


def default_preparation(problem: Problem) -> ZeroPhase:
    """How recordings are prepared by default."""
    return ZeroPhase(choose_cutoff([for_leg(problem.model, data) for data in problem.local_data]))


def default_start(problem: Problem) -> FloatArray:
    """β by weighted least squares on rows as they are prepared by default, whatever the problem's own preparation."""
    preparation = default_preparation(problem)
    if preparation != problem.preparation:
        problem = problem.changed(preparation=preparation)
    return wls(problem).solution.values


def refuse_other_friction(model: TorqueModel, estimator: str) -> None:
    """Refuse terms whose torque does not follow from the motion of the moment alone."""
    plain = type(model) is TorqueModel and not any(
        term.loaded or term.internal_state is not None or term.needs_temperature for term in model.terms
    )
    if not plain:
        raise NotSupportedError(
            f"{estimator} takes no friction that remembers, depends on load or temperature, or has free settings",
            remedy="use wls or huber, or give the settings numbers",
        )
