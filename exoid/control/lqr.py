"""Linear-quadratic regulation about a trajectory, by Pinocchio's analytical derivatives of the dynamics."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pinocchio as pin
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, FloatArray
from exoid.codegen import MOTION, Dialect, InputInC, LawInC
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.leg.joint_numbers import for_joints
from exoid.leg.model import configuration
from exoid.rig import Reference, Target
from exoid.tools.numbers import checked

from .c_description import describe
from .friction import AHEAD, FrictionCompensation, model_to_compensate
from .law import RATE, State, acceleration, refuse_rate
from .model import ControlModel, ModelSource

INSTANTS = 64
"""Number of instants of a period at which poses are taken."""


class Weights(NamedTuple):
    """Acceptable deviations, by Bryson's rule (Bryson and Ho 1975): each cost is (deviation / acceptable deviation)².

    Attributes:
        angle: Acceptable angle error [rad], a number or (n,).
        velocity: Acceptable velocity error [rad/s]; inf for no cost.
        torque: Acceptable torque in addition to the feedforward [N·m].
    """

    angle: ArrayLike = np.deg2rad(2.0)
    velocity: ArrayLike = np.inf
    torque: ArrayLike = 10.0

    def matrices(self, n: int) -> tuple[FloatArray, FloatArray]:
        """Make the cost matrices.

        Args:
            n: Number of joints.

        Returns:
            Q, (2n, 2n), and R, (n, n).

        Raises:
            ExoidError: A deviation is not positive, or does not fit n joints.
        """
        angle, velocity, torque = (for_joints(x, n, "weights") for x in self)
        for name, values in (("angle", angle), ("velocity", velocity), ("torque", torque)):
            checked(values, f"acceptable {name}", above=0.0, infinite=name == "velocity")
        return np.diag(np.concatenate([angle, velocity]) ** -2.0), np.diag(torque**-2.0)


TIME = InputInC("time", "time since the reference began, less any number of periods [s]", scalar=True)

STEP = """\
    {{real}} friction[{{N}}], nearest;
    int instant, k;
    nearest = {{function("fmod")}}({{function("rint")}}({{p}}_instants * in->time / {{p}}_period), {{p}}_instants);
    instant = (int)(nearest < {{number(0)}} ? nearest + {{p}}_instants : nearest);
    {{p}}_inverse_dynamics(in->q_d, in->v_d, in->a_d, tau);
{{friction}}
    for (j = 0; j < {{N}}; ++j) {
        tau[j] += friction[j];
        for (k = 0; k < {{N}}; ++k) {
            tau[j] += {{p}}_gain[instant][j][k] * (in->q_d[k] - in->q[k]);
            tau[j] += {{p}}_gain[instant][j][{{N}} + k] * (in->v_d[k] - in->v[k]);
        }
    }
"""


@dataclass(frozen=True, eq=False)
class LQR:
    """τ = M(θ_d) θ̈_d + C θ̇_d + G(θ_d) + F_r + K(t) (x_d − x), x = (θ, θ̇)."""

    model: ControlModel  # model of the feedforward
    gains: FloatArray  # gain K at equally spaced instants of the period [N·m/rad, N·m·s/rad], (instants, n, 2n)
    period: float  # period of the gains [s]
    friction: FrictionCompensation | None = AHEAD  # friction compensation; None for none
    rate: float = RATE  # sampling rate [Hz]

    def gain_at(self, time: float) -> FloatArray:
        """Look up the gain of the nearest instant."""
        count = len(self.gains)
        return np.asarray(self.gains[round(count * time / self.period) % count])

    def torque(self, state: State, target: Target) -> FloatArray:
        """Compute the torque; see the class."""
        torque = self.model.inverse_dynamics(target.q, target.v, acceleration(target))
        torque = torque + self.gain_at(state.time) @ np.concatenate([target.q - state.q, target.v - state.v])
        return np.asarray(torque if self.friction is None else torque + self.friction.torque(self.model, state, target))

    def in_c(self, dialect: Dialect) -> LawInC:
        """Describe the law in C: the gain is that of the nearest instant of the period."""
        return describe(
            self.model,
            self.friction,
            self.rate,
            dialect,
            equation="tau = M(q_d) a_d + C(q_d, v_d) v_d + G(q_d) + springs(q_d){friction} "
            "+ K(t) (x_d - x), x = (q, v)",
            step=STEP,
            calls=("inverse_dynamics",),
            inputs=(*MOTION, TIME),
            tables={
                "gain": (self.gains, f"K at {len(self.gains)} instants of the period [N m/rad, N m s/rad]"),
                "instants": (float(len(self.gains)), "number of instants"),
                "period": (self.period, "period [s]"),
            },
        )


def lqr(
    source: ModelSource,
    reference: Reference,
    period: float,
    *,
    weights: Weights | None = None,
    friction: FrictionCompensation | None = AHEAD,
    rate: float = RATE,
) -> LQR:
    """Make an :class:`LQR` controller about a reference.

    At each of some poses along the reference, the leg is linearised at rest and sampled at the controller's rate:
    x⁺ = A x + B u. The cost is Σ xᵀ Q x + uᵀ R u. K = (R + Bᵀ S B)⁻¹ Bᵀ S A, with S from the discrete algebraic Riccati
    equation of the pose.

    Args:
        source: An estimate, a leg, or a plant of one rig.
        reference: Reference of one leg.
        period: Period of the reference, or its duration [s].
        weights: Acceptable deviations; None for 2° and 10 N·m.
        friction: Friction compensation; None for none.
        rate: Sampling rate [Hz].

    Returns:
        The controller.

    Raises:
        ExoidError: The reference is not that of one such leg; weights, period or rate are not positive; or no gain
            stabilises.

    Warns:
        UserWarning: The friction coefficients are negative.
    """
    refuse_rate(rate)
    model = model_to_compensate(source, friction)
    poses = poses_along(reference, period)
    if poses.shape[1] != model.n:
        raise BadArgumentError(
            f"a reference of {poses.shape[1]} joints for a leg of {model.n}", remedy="give one of this leg"
        )
    costs = (weights or Weights()).matrices(model.n)
    gains = np.array([_optimal_gain(model, pose, costs, rate) for pose in poses])
    return LQR(model, gains, period, friction, rate)


def poses_along(reference: Reference, period: float) -> FloatArray:
    """Take angles of a reference at :data:`INSTANTS` equally spaced instants."""
    checked(period, "the period of the reference [s]", above=0.0)
    angles = [np.asarray(reference.at(period * k / INSTANTS).q) for k in range(INSTANTS)]
    if angles[0].ndim != 2 or angles[0].shape[1] != 1:
        raise BadArgumentError(f"a reference of shape {angles[0].shape}", remedy="give that of one leg, (n, 1)")
    return np.array(angles)[:, :, 0]


def _optimal_gain(
    model: ControlModel, pose: FloatArray, costs: tuple[FloatArray, FloatArray], rate: float
) -> FloatArray:
    """Gain that is optimal about a pose."""
    at_rest = np.zeros(model.n)
    A, B = discretise(linearise(model, pose, at_rest, at_rest), 1.0 / rate)
    Q, R = costs
    try:
        S = scipy.linalg.solve_discrete_are(A, B, Q, R)
    except np.linalg.LinAlgError as error:
        raise NotSupportedError(
            f"no stabilising gain ({error})", remedy="make angle errors cost more, or raise the rate"
        ) from error
    return np.asarray(scipy.linalg.solve(R + B.T @ S @ B, B.T @ S @ A))


class Linear(NamedTuple):
    """ẋ = A x + B u, or x⁺ = A x + B u, with x = (δq, δv) and u = δτ."""

    A: FloatArray  # state matrix, (2n, 2n)
    B: FloatArray  # input matrix, (2n, n)


def linearise(model: ControlModel, q: FloatArray, v: FloatArray, a: FloatArray) -> Linear:
    """Linearise forward dynamics in continuous time."""
    #     δv̇ = −M⁻¹ (∂τ/∂q + s'(q)) δq − M⁻¹ (∂τ/∂v + d) δv + M⁻¹ δτ
    #
    # with τ = RNEA(q, v, a). Springs that couple joints, and rotors that several joints turn, are included. Coulomb
    # friction, which has no derivative at rest, and terms of other kinds are left out.
    pinocchio, n = model.pinocchio, model.n
    data = pinocchio.createData()
    at = configuration(pinocchio, q[None])[0]
    by_q, by_v, _ = pin.computeRNEADerivatives(pinocchio, data, at, v, a)
    inverse = np.linalg.inv(model.mass_matrix(q))
    A, B = np.zeros((2 * n, 2 * n)), np.zeros((2 * n, n))
    A[:n, n:] = np.eye(n)
    A[n:, :n] = -inverse @ (by_q + _spring_rate(model, q))
    A[n:, n:] = -inverse @ (by_v + np.diag(model.viscous))
    B[n:] = inverse
    return Linear(A, B)


def discretise(continuous: Linear, period: float) -> Linear:
    """Discretise with the torque held over each period."""
    A, B = continuous
    sampled = scipy.signal.cont2discrete((A, B, np.eye(len(A)), np.zeros_like(B)), period)
    return Linear(*sampled[:2])


def _spring_rate(model: ControlModel, q: FloatArray) -> FloatArray:
    """Derivative of the springs [N·m/rad], (n, n): of the polynomials, and of terms that couple joints."""
    powers = np.arange(len(model.spring) - 1, 0, -1.0)[:, None]
    rate = np.diag((powers * model.spring[:-1] * q ** (powers - 1.0)).sum(axis=0))
    step = 1e-6  # [rad], of differences
    above, below = (q[:, None] + change * np.eye(model.n) for change in (step, -step))
    still = np.zeros_like(above)
    for other in model.others:
        if len(other.joints) > 1:
            difference = other.torque(above, still, still, still) - other.torque(below, still, still, still)
            rate[list(other.joints)] += difference / (2.0 * step)
    return rate
