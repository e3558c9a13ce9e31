"""Instrumental variables: columns of a simulated motion in place of those of the measured one (IDIM-IV)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.identification.problem import Problem
from exoid.regression.fit import Covariance, Fit
from exoid.regression.noise import AutoregressiveNoise, QuadraticForm
from exoid.regression.parameters import NO_PRIOR_KNOWLEDGE
from exoid.regression.residuals import Noises, Point, Sandwich, fit_noise, series
from exoid.regression.rows import for_leg
from exoid.signals import Recording
from exoid.torques import TorqueModel

from .closed_loop import ClosedLoop, as_possible
from .default_start import default_start, refuse_other_friction
from .least_squares import wls

ROUNDS = 8
"""Simulations at most."""

SETTLED = 0.02
"""Converged when no parameter moves by more than this part of its standard deviation."""

ROUNDING = 1e-12
"""Changes smaller than this do not count, whatever the standard deviation."""


@dataclass(frozen=True)
class InstrumentalVariables:
    """Instrumental variables: Σ Zᵀ (τ − W β) = 0 with Z the regressor of a simulation of the estimated model.

    The loop is simulated with the last estimate, Z made from it as W is from the recording, and β solved for, in turn.
    Noise in the angles makes W noisy but not Z, so that it no longer biases β. Filters stay: they take noise away from
    torques. What remains is bias of the terms that are not linear in the noise, such as friction near reversals.

    Attributes:
        loop: Controller, reference and actuator of all recordings.
    """

    loop: ClosedLoop | None = None

    @property
    def name(self) -> str:
        """``"iv"``."""
        return "iv"

    def __call__(self, problem: Problem) -> Fit:
        """Fit.

        Args:
            problem: Problem of one group.

        Returns:
            The fit.

        Raises:
            ExoidError: No loop was given, it cannot be simulated, or there are several groups.
        """
        problem.refuse_several_groups()
        if self.loop is None:
            raise ExoidError(
                "instruments come from a simulated loop, whose controller and reference must be known",
                remedy="pass estimator=InstrumentalVariables(ClosedLoop(controller, reference)), or use ml",
            )
        if problem.prior_knowledge != NO_PRIOR_KNOWLEDGE:
            raise ExoidError(
                "instrumental variables take no known parameters, priors or bounds",
                remedy="use output error, ml or wls, which do",
            )
        refuse_other_friction(problem.model, "iv")
        first = wls(problem)
        values = default_start(problem)
        instruments = _instruments(problem, self.loop, as_possible(problem.model, values))
        for _ in range(ROUNDS):
            before, (values, inverse) = values, _solve(problem, instruments, first.weights)
            covariance, noises = _covariance(problem, instruments, Point(values, first.weights), inverse)
            converged = bool((np.abs(values - before) <= SETTLED * np.sqrt(np.diag(covariance)) + ROUNDING).all())
            if converged:
                break
            try:
                instruments = _instruments(problem, self.loop, as_possible(problem.model, values))
            except ExoidError:  # no leg moves with such parameters
                break
        textbook = _sandwich(problem, instruments, Point(values, first.weights), inverse, without_memory(noises))
        solution = first.solution._replace(values=values, covariance=textbook)
        correlated = Covariance(covariance, None, covariance)
        warnings = () if converged else ("instrumental variables have not converged: prefer ml or output error",)
        return Fit(solution, first.weights, noises=noises, warnings=warnings, correlated=correlated)


def _instruments(problem: Problem, loop: ClosedLoop, values: FloatArray) -> Problem:
    """The same problem from simulated recordings; poses, whose angles are exact, are their own instruments."""
    data = [
        simulated_recording(problem.model, loop, values, item) if isinstance(item, Recording) else item
        for item in problem.local_data
    ]
    return problem.with_data(data)


def simulated_recording(model: TorqueModel, loop: ClosedLoop, values: FloatArray, recording: Recording) -> Recording:
    """What would have been recorded had the leg been the model, and sensors without noise."""
    recording = for_leg(model, recording).resampled()
    ran = loop.simulate(model, values[:, None], recording)
    return Recording(
        recording.time,
        ran.q[..., 0],
        tau=ran.tau[..., 0],
        joint_names=recording.joint_names,
        torso=recording.torso,
        largest_angle=math.inf,
    )


def without_memory(noises: Noises) -> Noises:
    """White noise of the same variances."""
    return {
        key: AutoregressiveNoise(np.zeros((1, 0)), noise.variances[:1], noise.samples) for key, noise in noises.items()
    }


class _Solved(NamedTuple):
    """β, and (ZᵀW)⁻¹ of the weighted rows."""

    values: FloatArray
    inverse: FloatArray


def _solve(problem: Problem, instruments: Problem, weights: Sequence[float]) -> _Solved:
    count = len(problem.names)
    ZW, Zt = np.zeros((count, count)), np.zeros(count)
    for block, simulated in zip(problem.blocks(), instruments.blocks(), strict=True):
        rows = block.rows
        for joint in range(rows.tau.shape[1]):
            use = rows.usable[:, joint] & simulated.rows.usable[:, joint]
            Z = weights[problem.weight_index(block.kind, joint)] ** 2 * simulated.rows.W[use, joint]
            ZW += Z.T @ rows.W[use, joint]
            Zt += Z.T @ rows.tau[use, joint]
    inverse = np.asarray(np.linalg.inv(ZW))
    return _Solved(inverse @ Zt, inverse)


def _covariance(problem: Problem, instruments: Problem, point: Point, inverse: FloatArray) -> Sandwich:
    """(ZᵀW)⁻¹ ZᵀΓZ (WᵀZ)⁻¹ with Γ the autoregressive noise in the residuals."""
    noises = fit_noise(problem, point, np.zeros_like(inverse))
    return Sandwich(_sandwich(problem, instruments, point, inverse, noises), noises)


def _sandwich(problem: Problem, instruments: Problem, point: Point, inverse: FloatArray, noises: Noises) -> FloatArray:
    """(ZᵀW)⁻¹ ZᵀΓZ (WᵀZ)⁻¹ with the noise given."""
    meat = np.zeros_like(inverse)
    running: dict[int, QuadraticForm] = {}
    for part, simulated in zip(series(problem, point), series(instruments, point), strict=True):
        if part.begins:
            running[part.joint] = QuadraticForm(noises[part.kind, part.joint], len(part.columns))
        running[part.joint].add(simulated.X * part.usable)
        if part.ends:
            meat[np.ix_(part.columns, part.columns)] += part.stands_for**2 * running[part.joint].total()
    covariance = inverse @ meat @ inverse.T
    return np.asarray(0.5 * (covariance + covariance.T))
