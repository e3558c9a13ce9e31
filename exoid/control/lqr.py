"""Linear-quadratic regulation along a trajectory: gains that follow the leg through its motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.leg import Leg
from exoid.rig import Plant, Reference, Target

from .estimate_checks import warn_of_active_friction
from .friction import AHEAD, FrictionCompensation
from .law import RATE, State, acceleration, refuse_rate
from .linearise import Linear, discretise, linearise
from .model import ControlModel

POINTS = 100
"""Gains along one stride in the work that document 2 cites (its [10])."""

CONVERGED, SWEEPS = 1e-9, 100
"""Of a periodic cost: relative change from one period to the next, and how many are tried."""


class Weights(NamedTuple):
    """What counts as large, by Bryson's rule: each cost is the square of a quantity over its size here.

    Attributes:
        angle: Of an angle error [rad], a number or (n,).
        velocity: Of a velocity error [rad/s]; inf for no cost.
        torque: Of a torque beside the feed-forward [N·m].
    """

    angle: ArrayLike = np.deg2rad(2.0)
    velocity: ArrayLike = np.inf
    torque: ArrayLike = 10.0

    def matrices(self, n: int) -> tuple[FloatArray, FloatArray]:
        """Q, (2n, 2n), and R, (n, n).

        Raises:
            ExoidError: A size is not positive, or does not fit n joints.
        """
        try:
            angle, velocity, torque = (np.broadcast_to(np.asarray(x, dtype=np.float64), (n,)) for x in self)
        except (TypeError, ValueError):
            raise ExoidError(f"weights {self} for {n} joints", remedy="give a number, or one for each joint") from None
        finite = np.isfinite(angle).all() and np.isfinite(torque).all()
        if not (finite and (angle > 0.0).all() and (velocity > 0.0).all() and (torque > 0.0).all()):
            raise ExoidError(f"weights {self}", remedy="give what counts as a large error, and a large torque")
        return np.diag(np.concatenate([angle, velocity]) ** -2.0), np.diag(torque**-2.0)


@dataclass(frozen=True, eq=False)
class LQR:
    """τ = M(θ_d) θ̈_d + C θ̇_d + G(θ_d) + F_r + K(t) (x_d − x), x = (θ, θ̇).

    Attributes:
        model: Whose inverse dynamics is fed forward.
        gain: K of each point, in N·m/rad and N·m·s/rad, (P, n, 2n).
        duration: Which the points divide evenly [s].
        periodic: Whether they begin anew after it; if not, the last one stays.
        friction: How friction is compensated; None for not at all.
        rate: [Hz].
    """

    model: ControlModel
    gain: FloatArray
    duration: float
    periodic: bool = True
    friction: FrictionCompensation | None = AHEAD
    rate: float = RATE

    def gain_at(self, time: float) -> FloatArray:
        """K at a time [s], (n, 2n)."""
        points = len(self.gain)
        point = int(points * time / self.duration + 1e-9)
        return np.asarray(self.gain[point % points if self.periodic else min(point, points - 1)])

    def torque(self, state: State, target: Target) -> FloatArray:
        """See the class.

        Raises:
            ExoidError: The target has no acceleration.
        """
        torque = self.model.inverse_dynamics(target.q, target.v, acceleration(target))
        error = np.concatenate([target.q - state.q, target.v - state.v])
        torque = torque + self.gain_at(state.time) @ error
        if self.friction is not None:
            torque = torque + self.friction.torque(self.model, state, target)
        return np.asarray(torque)


def lqr(
    source: Estimate | Leg | Plant | ControlModel,
    reference: Reference,
    duration: float,
    *,
    weights: Weights | None = None,
    points: int = POINTS,
    periodic: bool = True,
    friction: FrictionCompensation | None = AHEAD,
    rate: float = RATE,
) -> LQR:
    """Make an :class:`LQR` law along a reference.

    The leg is linearised at the middle of each of ``points`` stretches of the reference and sampled at the law's rate;
    K follows from the Riccati recursion backwards in time, K = (R + Bᵀ S B)⁻¹ Bᵀ S A, S = Q + Aᵀ S (A − B K).

    Args:
        source: An estimate, a leg, or a plant of one rig.
        reference: Of one leg, with accelerations.
        duration: Of the reference [s]; its period where it is periodic.
        weights: None for 2° and 10 N·m.
        points: How many gains are kept.
        periodic: Whether the reference repeats itself: S is then the one that repeats itself too. If not, the recursion
            begins at the end with the S of the last stretch going on for ever.
        friction: How friction is compensated; None for not at all.
        rate: At which it is sampled [Hz].

    Raises:
        ExoidError: There are more points than samples, weights or duration are not positive, or no S repeats itself.

    Warns:
        UserWarning: The friction coefficients are negative.
    """
    refuse_rate(rate)
    model = ControlModel.of(source)
    if friction is not None:
        warn_of_active_friction(model)
    samples = round(duration * rate) if 0.0 < duration < np.inf else 0
    if not 1 <= points <= samples:
        raise ExoidError(
            f"{points} gains over {duration:g} s at {rate:g} Hz", remedy="keep at least one, at most one a sample"
        )
    stretches = [_sampled(model, reference, (k + 0.5) * duration / points, rate) for k in range(points)]
    which = [k * points // samples for k in range(samples)]
    Q, R = (weights or Weights()).matrices(model.n)
    gains = riccati([stretches[k] for k in which], Q, R, periodic=periodic)
    kept = [gains[(2 * k + 1) * samples // (2 * points)] for k in range(points)]
    return LQR(model, np.array(kept), duration, periodic, friction, rate)


def riccati(steps: Sequence[Linear], Q: FloatArray, R: FloatArray, *, periodic: bool) -> list[FloatArray]:
    """Optimal gains of x⁺ = A x + B u with the cost Σ xᵀ Q x + uᵀ R u, u = −K x.

    Args:
        steps: A and B of each step.
        Q: (2n, 2n).
        R: (n, n).
        periodic: Whether the steps repeat for ever, or the last one does.

    Returns:
        K of each step.

    Raises:
        ExoidError: There is no stabilising solution.
    """
    try:
        S = np.asarray(scipy.linalg.solve_discrete_are(*steps[-1], Q, R))
    except np.linalg.LinAlgError as error:
        raise ExoidError(f"no stabilising gain ({error})", remedy="weigh angles too, or raise the rate") from error
    for _ in range(SWEEPS if periodic else 1):
        before, gains = S, list[FloatArray]()
        for A, B in reversed(steps):
            K = np.asarray(np.linalg.solve(R + B.T @ S @ B, B.T @ S @ A), dtype=np.float64)
            S = Q + A.T @ S @ (A - B @ K)
            S = 0.5 * (S + S.T)
            gains.append(K)
        if not periodic or np.abs(S - before).max() <= CONVERGED * np.abs(S).max():
            return gains[::-1]
    raise ExoidError("no cost that repeats itself", remedy="choose larger weights of angle and velocity errors")


def _sampled(model: ControlModel, reference: Reference, time: float, rate: float) -> Linear:
    target = reference.at(time)
    q, v, a = (np.asarray(x, dtype=np.float64).reshape(-1) for x in (target.q, target.v, acceleration(target)))
    if len(q) != model.n:
        raise ExoidError(
            f"a reference of shape {np.shape(target.q)} for a leg of {model.n} joints", remedy="give that of one leg"
        )
    return discretise(linearise(model, q, v, a), 1.0 / rate)
