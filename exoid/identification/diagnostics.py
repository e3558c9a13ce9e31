"""What the residuals say on the trust that an estimate deserves."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.torques import TorqueModel

from .assumed import Assumed
from .noise import LagSums
from .problem import Kind, Problem
from .residuals import Noises, Point, Series, over_recordings
from .rows import Triangle

WELL = 0.1
"""A parameter is well determined if its standard deviation is at most this part of its size,"""

WEAKLY = 0.3
"""and weakly if it is at most this part; beyond, it is not determined."""

SIZE = 0.1
"""A value near zero is judged by this part of the value that would explain all torque of a joint alone."""

MOSTLY_PRIOR = 0.7
"""A standard deviation beyond this part of the prior's says that the recordings know less than the prior."""

BELOW_ZERO = 0.005
"""Probability with which a parameter that is zero would be said to be negative."""

CANCELS = 3.0
"""A value that alone would give so many times all torque of a joint only cancels another, whatever its error."""

LAGS = 10
"""Autocorrelations that are tested for whiteness."""


@dataclass(frozen=True)
class JointNoise:
    """What the residuals of one joint look like.

    Attributes:
        samples: Rows that were looked at, thinned to the pace at which a filter leaves them independent.
        effective_samples: Independent samples that say as much on the size of the noise, N γ_0² / Σ γ_k².
        order: Of the autoregressive model of the noise, the largest of all recordings.
        correlation: Of one residual with the next.
        whiteness: Probability of autocorrelations as large as these in white noise (Ljung and Box); below 0.05 the
            residuals are not white, which intervals account for.
    """

    samples: int
    effective_samples: float
    order: int
    correlation: float
    whiteness: float


def judge_noise(problem: Problem, point: Point, noises: Noises) -> tuple[JointNoise, ...]:
    """Describe the residuals of each joint."""
    joints = len(problem.model.leg.joint_names)
    samples, effective, statistic, lags = np.zeros((4, joints))
    products = np.zeros((joints, 2))
    for found in over_recordings(problem, point, _autocorrelate):
        for (kind, joint), (sums, pairs) in found.items():
            samples[joint] += pairs[0]
            effective[joint] += pairs[0] * noises[kind, joint].effective_share
            if not kind.at_rest and pairs[0] > 2 * LAGS and sums[0] > 0.0:
                correlations = sums[1:] / np.maximum(pairs[1:], 1.0) * pairs[0] / sums[0]
                statistic[joint] += (pairs[1:] * correlations**2).sum()
                lags[joint] += LAGS
                products[joint] += sums[:2]
    return tuple(
        JointNoise(
            samples=int(samples[joint]),
            effective_samples=float(effective[joint]),
            order=max(noise.order for (_, j), noise in noises.items() if j == joint),
            correlation=float(products[joint, 1] / (products[joint, 0] or 1.0)),
            whiteness=float(scipy.stats.chi2.sf(statistic[joint], lags[joint])) if lags[joint] else 1.0,
        )
        for joint in range(joints)
    )


def _autocorrelate(parts: Iterator[Series]) -> dict[tuple[Kind, int], tuple[FloatArray, FloatArray]]:
    """Sums over residuals, and pairs of usable samples, by lag, of each joint of one recording."""
    running: dict[tuple[Kind, int], tuple[LagSums, LagSums]] = {}
    for part in parts:
        residuals, pairs = running.setdefault((part.kind, part.joint), (LagSums(LAGS), LagSums(LAGS)))
        residuals.add(part.residual)
        pairs.add(part.usable)
    return {key: (residuals.sums, np.rint(pairs.sums)) for key, (residuals, pairs) in running.items()}


def judge_sizes(triangles: Sequence[Triangle]) -> FloatArray:
    """Return the size of each parameter that would explain, alone, all torque of a joint it acts on, (P,).

    That is ‖τ‖ / ‖W_i‖ of the joint where it is smallest; zero for one that left no trace.
    """
    norms = np.array([np.linalg.norm(triangle.R, axis=0) for triangle in triangles])
    columns, torques = norms[:, :-1], norms[:, -1:]
    sizes = np.divide(torques, columns, out=np.full_like(columns, np.inf), where=columns > 0.0).min(axis=0)
    return np.where(np.isfinite(sizes), sizes, 0.0)


def verdict(value: float, std: float, size: float) -> str:
    """Say how well a parameter is determined: "well", "weakly" or "not"."""
    if abs(value) > CANCELS * size > 0.0:
        return "not"
    scale = max(abs(value), SIZE * size)
    if std <= WELL * scale:
        return "well"
    return "weakly" if std <= WEAKLY * scale else "not"


def verdict_beside(name: str, assumed: Assumed, std: float, of_data: str) -> str:
    """Say "known" or "prior" of parameters that are rather what was assumed than what was measured."""
    if name in assumed.known:
        return "known"
    believed = assumed.prior.values.get(name)
    return "prior" if believed is not None and std > MOSTLY_PRIOR * believed[1] else of_data


def negative(model: TorqueModel, values: FloatArray, std: FloatArray) -> tuple[str, ...]:
    """Name friction, rotor inertia and a segment's J that are negative by more than their error."""
    limit = float(scipy.stats.norm.ppf(1.0 - BELOW_ZERO))
    planar = model.leg.chain is not None
    inertia = np.array([planar and name in model.leg.parameter_names and name[0] == "J" for name in model.names])
    below = (model.nonnegative | inertia) & (values < 0.0) & (values < -limit * std)
    if not below.any():
        return ()
    names = ", ".join(name for name, is_below in zip(model.names, below, strict=True) if is_below)
    return (
        f"{names} negative beyond error, which nature does not allow: a term is missing, a sign is wrong, or the "
        "torque is not that of this joint",
    )
