"""Linear-quadratic regulation about a trajectory."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError
from exoid.rig import Reference, Target

from .estimate_checks import model_to_compensate
from .friction import AHEAD, FrictionCompensation
from .law import RATE, State, acceleration, refuse_rate
from .linearise import discretise, linearise
from .mean_pose import mean_pose
from .model import ControlModel, ModelSource


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
    """τ = M(θ_d) θ̈_d + C θ̇_d + G(θ_d) + F_r + K (x_d − x), x = (θ, θ̇).

    Attributes:
        model: Whose inverse dynamics is fed forward.
        gain: K in N·m/rad and N·m·s/rad, (n, 2n).
        friction: How friction is compensated; None for not at all.
        rate: [Hz].
    """

    model: ControlModel
    gain: FloatArray
    friction: FrictionCompensation | None = AHEAD
    rate: float = RATE

    def torque(self, state: State, target: Target) -> FloatArray:
        """See the class.

        Raises:
            ExoidError: The target has no acceleration.
        """
        torque = self.model.inverse_dynamics(target.q, target.v, acceleration(target))
        torque = torque + self.gain @ np.concatenate([target.q - state.q, target.v - state.v])
        if self.friction is not None:
            torque = torque + self.friction.torque(self.model, state, target)
        return np.asarray(torque)


def lqr(
    source: ModelSource,
    reference: Reference,
    period: float,
    *,
    weights: Weights | None = None,
    friction: FrictionCompensation | None = AHEAD,
    rate: float = RATE,
) -> LQR:
    """Make an :class:`LQR` law about a reference.

    The leg is linearised at rest at the mean pose of the reference and sampled at the law's rate: x⁺ = A x + B u. The
    cost is Σ xᵀ Q x + uᵀ R u, so K = (R + Bᵀ S B)⁻¹ Bᵀ S A with S from the discrete algebraic Riccati equation.

    Args:
        source: An estimate, a leg, or a plant of one rig.
        reference: Of one leg.
        period: Of the reference, or its duration [s].
        weights: None for 2° and 10 N·m.
        friction: How friction is compensated; None for not at all.
        rate: At which it is sampled [Hz].

    Returns:
        The law.

    Raises:
        ExoidError: The reference is not of one such leg, weights, period or rate are not positive, or no gain
            stabilises.

    Warns:
        UserWarning: The friction coefficients are negative.
    """
    refuse_rate(rate)
    model = model_to_compensate(source, friction)
    pose = mean_pose(reference, period)
    if len(pose) != model.n:
        raise ExoidError(f"a reference of {len(pose)} joints for a leg of {model.n}", remedy="give one of this leg")
    A, B = discretise(linearise(model, pose, np.zeros(model.n), np.zeros(model.n)), 1.0 / rate)
    Q, R = (weights or Weights()).matrices(model.n)
    try:
        S = scipy.linalg.solve_discrete_are(A, B, Q, R)
    except np.linalg.LinAlgError as error:
        raise ExoidError(f"no stabilising gain ({error})", remedy="weigh angles too, or raise the rate") from error
    return LQR(model, np.asarray(scipy.linalg.solve(R + B.T @ S @ B, B.T @ S @ A)), friction, rate)
