"""Linearisation of the leg about a motion, with Pinocchio's analytical derivatives."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio as pin
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.leg.model import configuration

from .model import ControlModel


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
    A[n:, :n] = -inverse @ (by_q + model.spring_rate(q))
    A[n:, n:] = -inverse @ (by_v + np.diag(model.viscous))
    B[n:] = inverse
    return Linear(A, B)


def discretise(continuous: Linear, period: float) -> Linear:
    """Discretise with the torque held over each period."""
    A, B = continuous
    sampled = scipy.signal.cont2discrete((A, B, np.eye(len(A)), np.zeros_like(B)), period)
    return Linear(*sampled[:2])
