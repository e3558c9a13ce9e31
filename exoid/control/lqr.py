"""Linear-quadratic regulation about a reference, by Pinocchio's analytical derivatives of the dynamics."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import NotSupportedError
from exoid.leg.joint_numbers import for_joints
from exoid.leg.model import configuration
from exoid.tools.numbers import checked

from .friction import AHEAD, FrictionCompensation, model_to_compensate
from .law import RATE, refuse_rate
from .model import ControlModel, ModelSource, possible_mass_matrix
from .tracking_law import TrackingLaw


def lqr(
    source: ModelSource,
    pose: ArrayLike,
    *,
    angle_deg: ArrayLike = 2.0,
    torque: ArrayLike = 10.0,
    friction: FrictionCompensation | None = AHEAD,
    rate: float = RATE,
) -> TrackingLaw:
    """Make LQR, τ = M(θ_d) θ̈_d + C θ̇_d + G(θ_d) + F_r + K (x_d − x) with x = (θ, θ̇) and one gain K for all poses.

    The leg is linearised at rest in a pose and sampled at the controller's rate: x⁺ = A x + B u. The cost is
    Σ xᵀ Q x + uᵀ R u, each part (deviation / acceptable deviation)² by Bryson's rule (Bryson and Ho 1975).
    K = (R + Bᵀ S B)⁻¹ Bᵀ S A, with S from the discrete algebraic Riccati equation.

    Args:
        source: An estimate, a leg, or a plant of one rig.
        pose: Angles [rad], (n,), such as :func:`exoid.control.mean_pose` of a reference.
        angle_deg: Acceptable angle error [deg], a number or (n,); a degree of a slide is 1.7 mm.
        torque: Acceptable torque in addition to the feedforward [N·m], likewise.
        friction: Friction compensation; None for none.
        rate: Sampling rate [Hz].

    Returns:
        The controller.

    Raises:
        ExoidError: The pose is not that of such a leg; deviations or rate are not positive; or no gain stabilises.

    Warns:
        UserWarning: The friction coefficients are negative.
    """
    refuse_rate(rate)
    model = model_to_compensate(source, friction)
    n, at_rest = model.n, np.zeros(model.n)
    about = for_joints(checked(pose, "the pose"), n, "angles of the pose")
    acceptable = (checked(x, "an acceptable deviation", above=0.0) for x in (angle_deg, torque))
    angles, torques = (for_joints(x, n, "acceptable deviations") for x in acceptable)
    linear = (*linearise(model, about, at_rest, at_rest), np.eye(2 * n), np.zeros((2 * n, n)))
    A, B, *_ = scipy.signal.cont2discrete(linear, 1.0 / rate)  # a torque is held over each period
    Q, R = np.diag(np.append((np.deg2rad(angles) * model.radian) ** -2.0, at_rest)), np.diag(torques**-2.0)
    try:
        S = scipy.linalg.solve_discrete_are(A, B, Q, R)
    except np.linalg.LinAlgError as error:
        what, remedy = f"no stabilising gain ({error})", "make angle errors cost more, or raise the rate"
        raise NotSupportedError(what, remedy=remedy) from error
    K = np.asarray(scipy.linalg.solve(R + B.T @ S @ B, B.T @ S @ A))
    return TrackingLaw("optimal", K[:, :n], K[:, n:], model, friction, rate)


def linearise(model: ControlModel, q: FloatArray, v: FloatArray, a: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Linearise forward dynamics in continuous time, ẋ = A x + B u with x = (δq, δv) and u = δτ."""
    #     δv̇ = −M⁻¹ (∂τ/∂q + s'(q)) δq − M⁻¹ (∂τ/∂v + d) δv + M⁻¹ δτ
    #
    # with τ = RNEA(q, v, a). Springs that couple joints, and rotors that several joints turn, are included. Coulomb
    # friction, which has no derivative at rest, and terms of other kinds are left out.
    pinocchio, n = model.pinocchio, model.n
    data = pinocchio.createData()
    at = configuration(pinocchio, q[None])[0]
    by_q, by_v, _ = pin.computeRNEADerivatives(pinocchio, data, at, v, a)
    inverse, step = np.linalg.inv(possible_mass_matrix(model, q)), 1e-5 * np.eye(n)  # [rad]
    of_springs = (model.springs(q[:, None] + step) - model.springs(q[:, None] - step)) / 2e-5
    A, B = np.zeros((2 * n, 2 * n)), np.zeros((2 * n, n))
    A[:n, n:] = np.eye(n)
    A[n:, :n] = -inverse @ (by_q + of_springs)
    A[n:, n:] = -inverse @ (by_v + np.diag(model.viscous))
    B[n:] = np.where(model.drives, inverse, 0.0)
    return A, B
