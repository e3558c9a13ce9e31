"""From R factors to values, weights and an estimate."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.estimate.data import Input
from exoid.estimate.finding import Finding
from exoid.leg.lift import check, lift
from exoid.regression.diagnostics import parameter_scale
from exoid.regression.least_squares import RFactor, solve, stack
from exoid.regression.parameters import PriorKnowledge

from .correlation import inflations
from .settings import Settings
from .state import Information, State

DETERMINED = 1e-7
"""Smallest diagonal of the R factor with columns of unit length that counts as determined."""

NOISELESS = 1e-9
"""Residuals below this part of the torque are rounding."""

FEWEST_ROWS = 100
"""Fewest rows of a joint from which the size of its noise is taken, once there was an earlier value."""


class Current(NamedTuple):
    """Solution of the R factors by the last block."""

    values: FloatArray  # parameters, (P,)
    std: FloatArray  # standard deviations by the R factors alone, (P,)
    weights: FloatArray  # weights of the rows of each joint [1/(N·m)], (n,)


def current(settings: Settings, information: Information, weights: FloatArray, inflation: FloatArray) -> Current | None:
    """Solve for the values, fast."""
    R = weighted_stack(information, weights, inflation)
    root, z = R[:-1, :-1], R[:-1, -1]
    size = np.sqrt((root**2).sum(axis=0))
    if not (np.abs(np.diag(root)) > DETERMINED * size).all() or not size.all():
        return None
    inverse = scipy.linalg.lapack.dtrtri(root)[0]
    values = inverse @ z
    std = np.sqrt((inverse**2).sum(axis=1))
    if settings.estimator == "ols":
        return Current(values, std, weights)
    return Current(values, std, new_weights(information, values, weights))


def weighted_stack(information: Information, weights: FloatArray, inflation: FloatArray) -> FloatArray:
    """R factor of all rows, weighted, with what was known before them, (P + 1, P + 1)."""
    of_slots = np.append(weights, np.sqrt(inflation.mean()))
    table = (information.R * of_slots[:, None, None]).reshape(-1, information.R.shape[2])
    return np.asarray(np.linalg.qr(table, mode="r"))


def new_weights(information: Information, values: FloatArray, before: FloatArray) -> FloatArray:
    """Weights 1/RMS of the residuals of each joint; those before where rows are few."""
    rms, floor = residual_rms(information, values)
    enough = information.rows[:-1] >= FEWEST_ROWS
    return np.where(enough, 1.0 / np.maximum(np.maximum(rms, floor), 1e-150), before)


def residual_rms(information: Information, values: FloatArray) -> tuple[FloatArray, float]:
    """RMS residual of each joint (n,), and the size below which it is rounding [N·m]."""
    rows = np.maximum(information.rows[:-1], 1e-9)
    at = np.append(values, -1.0)
    norms = np.linalg.norm(information.R[:-1] @ at, axis=1)
    torque = np.linalg.norm(information.R[:-1, :, -1], axis=1) / np.sqrt(rows)
    return norms / np.sqrt(rows), NOISELESS * float(torque.max())


def estimate_of(settings: Settings, state: State, findings: tuple[Finding, ...]) -> Estimate:
    """Make the estimate of a state.

    The covariance is A⁻¹ (Σ_j w_j⁴ s_j² c_j A_j) A⁻¹ with A = Σ_j w_j² A_j: the noise of joint j has the size s_j, and
    c_j = 1 + 2 Σ_k ρ_k of its rows say as much as one independent row, by the autocorrelation ρ_k of residuals.

    Args:
        settings: Settings.
        state: The state.
        findings: Faults of the stream.

    Returns:
        The estimate.

    Raises:
        ExoidError: The rows so far do not determine every parameter: names them.
    """
    model, (R, rows) = settings.model, state.information
    if not rows[:-1].any() and not R[-1].any():
        raise ExoidError("no row so far: nothing can be estimated", remedy="move the leg, and update for longer")
    inflation = inflations(settings, state.correlation)
    samples = np.append(rows[:-1] / inflation, rows[-1])
    factors = [RFactor(R[j], round(rows[j]), float(samples[j])) for j in range(len(R))]
    knowledge = PriorKnowledge(nonnegative=settings.nonnegative or settings.consistent)
    bounds = model.nonnegative if knowledge.nonnegative else None
    weights, rms = _weights(settings, state, factors, knowledge)
    own = np.append(weights, np.sqrt(np.mean(inflation * (rms * weights) ** 2)))
    solution = solve(stack(factors, own.tolist()), model.names, knowledge, bounds)
    rms, _ = _rms_of(state, solution.values)
    noise = np.append(own[:-1] ** 4 * rms**2 * inflation, own[-1] ** 2)
    middle = np.einsum("s,sij,sik->jk", noise, R[:, :, :-1], R[:, :, :-1])
    unbiased = max(samples.sum(), 2.0) / max(solution.dof, 1.0)
    covariance = unbiased * solution.inverse @ middle @ solution.inverse
    values = _consistent(settings, solution.values, covariance) if settings.consistent else solution.values
    scale = parameter_scale([factor for factor in factors[:-1] if factor.rows] or factors)
    return Estimate(
        model=model,
        values=values,
        covariance=0.5 * (covariance + covariance.T),
        condition_number=max(solution.condition_number, 1.0),
        dof=max(solution.dof, 1.0),
        residual_rms=rms,
        estimator=f"recursive {settings.estimator}",
        preparation=settings.preparation,
        inputs=(Input("stream", "", state.samples, settings.rate),),
        parameter_scale=scale,
        bounded=tuple(model.names[k] for k in solution.bounded),
        findings=findings,
        cutoff_source="" if settings.cutoff is None else "passed to the recursive estimator",
    )


def _weights(
    settings: Settings, state: State, factors: list[RFactor], knowledge: PriorKnowledge
) -> tuple[FloatArray, FloatArray]:
    """Weights as those of the batch estimators, and the RMS residuals that they follow from."""
    ones = np.ones(settings.n)
    bounds = settings.model.nonnegative if knowledge.nonnegative else None
    if state.information.R[-1].any():  # rows of a joint may be too few to tell the size of its noise
        rms, _ = _rms_of(state, state.values)
        return (ones if settings.estimator == "ols" else 1.0 / np.maximum(rms, 1e-150)), rms
    first = solve(stack(factors), settings.model.names, knowledge, bounds).values
    rms, floor = residual_rms(state.information, first)
    return (ones if settings.estimator == "ols" else 1.0 / np.maximum(np.maximum(rms, floor), 1e-150)), rms


def _rms_of(state: State, values: FloatArray) -> tuple[FloatArray, float]:
    """RMS residuals; those of earlier weights where rows are few."""
    rms, floor = residual_rms(state.information, values)
    few = (state.information.rows[:-1] < FEWEST_ROWS) & bool(state.information.R[-1].any())
    return np.where(few, 1.0 / state.weights, np.maximum(rms, floor)), floor


def _consistent(settings: Settings, values: FloatArray, covariance: FloatArray) -> FloatArray:
    """Values of the physically possible links that are nearest to these."""
    leg = settings.model.leg
    count = len(leg.parameter_names)
    if check(leg, values[:count]).physical:
        return values
    lifted = lift(leg, values[:count], covariance[:count, :count])
    return np.concatenate([lifted.values, values[count:]])
