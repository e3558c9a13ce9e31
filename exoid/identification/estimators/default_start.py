"""Where iterations begin."""

from __future__ import annotations

from exoid._typing import FloatArray
from exoid.identification.problem import Problem
from exoid.identification.rows import for_leg
from exoid.signals import ZeroPhase, choose_cutoff

from .wls import wls


def default_preparation(problem: Problem) -> ZeroPhase:
    """How recordings are prepared by default."""
    return ZeroPhase(choose_cutoff([for_leg(problem.model, data) for data in problem.data]))


def default_start(problem: Problem) -> FloatArray:
    """β by weighted least squares on rows as they are prepared by default, whatever the problem's own preparation."""
    preparation = default_preparation(problem)
    if preparation != problem.preparation:
        problem = Problem(problem.model, problem.data, preparation, problem.assumed)
    return wls(problem).solution.values
