"""Clearance of a swinging foot over the ground, with its probability from the covariance of an estimate."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, FloatArray
from exoid.control.model import ControlModel
from exoid.errors import BadArgumentError
from exoid.estimate import EstimateData
from exoid.tools.numbers import checked


@dataclass(frozen=True, eq=False)
class ToeClearance:
    """Clearance over a swing.

    Attributes:
        planned: Height of the lowest point of the foot over the ground on the reference [m], (N,).
        touches: Probability that the foot touches during the swing, P(min c < 0).
        least: Least clearance that holds with a probability of 95 % [m].
    """

    planned: FloatArray
    touches: float
    least: float


def toe_clearance(
    estimate: EstimateData,
    time: FloatArray,
    q: FloatArray,
    height: Callable[[FloatArray], FloatArray],
    *,
    kp: ArrayLike,
    kd: ArrayLike,
    start_std: ArrayLike = 0.0,
    carried_std: float = 0.0,
    seed: int = 0,
) -> ToeClearance:
    """Compute the clearance of a foot that computed torque moves through a swing.

    The law τ = M̂(a_d + kd ė + kp e) + ĥ leaves the error e with ë + kd ė + kp e = M⁻¹ Y(q_d, v_d, a_d) δβ, where
    δβ ~ N(0, Σ) is the error of the estimate. The height is c = c_d − ∂c/∂q e. Draws of δβ, of the error at lift-off
    and of the height of the hip give the distribution of its minimum.

    Args:
        estimate: Estimate of one leg on a fixed base: its rigid bodies and friction.
        time: Times of the swing at one rate [s], (N,), from lift-off.
        q: Reference of the joints [rad], (N, n).
        height: Function from angles (N, n) to the height of the lowest point of the foot over the ground at these times
            [m], (N,).
        kp: Gain of angles [1/s²], a number or (n,).
        kd: Gain of rates [1/s], likewise.
        start_std: Standard deviation of the angles at lift-off [rad], a number or (n,).
        carried_std: Standard deviation of the height of the hip [m], constant over the swing.
        seed: Seed of the draws.

    Returns:
        The clearance.

    Raises:
        ExoidError: The base floats, times are not equally spaced, or shapes do not fit.
    """
    leg, n = estimate.leg, q.shape[1]
    steps = np.diff(time)
    if leg.base_rows or q.shape != (len(time), len(leg.joint_names)) or not np.allclose(steps, steps[0], rtol=1e-6):
        what = f"a swing of {len(time)} times and angles {q.shape}"
        raise BadArgumentError(what, remedy="give one leg on a fixed base, at one rate")
    checked(carried_std, "the standard deviation of the height [m]", least=0.0)
    gains = [np.broadcast_to(checked(x, "a gain", above=0.0), n) for x in (kp, kd)]
    curve = scipy.interpolate.CubicSpline(time, q)
    v, a = curve(time, 1), curve(time, 2)
    Y = estimate.model.regressor(q, v, a)  # (N, n, P)
    model = ControlModel.of_parameters(estimate.model, estimate.values)
    drive = np.linalg.solve(model.leg.mass_matrix(q) + model.rotors(q), Y)
    E = np.empty_like(drive)
    for j, (stiff, damp) in enumerate(zip(*gains, strict=True)):
        b, den = scipy.signal.bilinear([1.0], [1.0, float(damp), float(stiff)], 1.0 / float(steps[0]))
        E[:, j] = scipy.signal.lfilter(b, den, drive[:, j], axis=0)
    rng = np.random.default_rng(seed)
    draws = 10_000
    errors = rng.multivariate_normal(np.zeros(len(estimate.values)), estimate.covariance, draws)  # (D, P)
    # ∂c/∂q by central differences, (N, n)
    slope = np.stack([(height(q + 1e-6 * row) - height(q - 1e-6 * row)) / 2e-6 for row in np.eye(n)], axis=1)
    planned = height(q)
    drawn = planned - errors @ np.einsum("nj,njp->np", slope, E).T
    start = np.broadcast_to(checked(start_std, "start_std", least=0.0), n) * rng.standard_normal((draws, n))
    free = (np.array([[0.0, 1.0], [-kp, -kd]]) for kp, kd in zip(*gains, strict=True))  # ë + kd ė + kp e = 0
    decay = np.column_stack([scipy.linalg.expm((time - time[0])[:, None, None] * A)[:, 0, 0] for A in free])
    drawn -= np.einsum("nj,nj,dj->dn", slope, decay, start)
    drawn += carried_std * rng.standard_normal((draws, 1))
    lowest = drawn.min(axis=1)
    return ToeClearance(planned, float(np.mean(lowest < 0.0)), float(np.quantile(lowest, 0.05)))
