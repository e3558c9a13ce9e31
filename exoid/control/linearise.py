"""The leg linearised about a motion, with Pinocchio's analytical derivatives."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio as pin
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.model import configuration

from .model import ControlModel


class Linear(NamedTuple):
    """ẋ = A x + B u, or x⁺ = A x + B u, with x = (δq, δv) and u = δτ.

    Attributes:
        A: (2n, 2n).
        B: (2n, n).
    """

    A: FloatArray
    B: FloatArray


def linearise(model: ControlModel, q: FloatArray, v: FloatArray, a: FloatArray) -> Linear:
    """Linearise forward dynamics in continuous time.

        δv̇ = (∂v̇/∂q − M⁻¹ s'(q)) δq + (∂v̇/∂v − M⁻¹ d) δv + M⁻¹ δτ

    Coulomb friction, which has no derivative where it matters, and terms of unknown kinds are left out.

    Args:
        model: The model.
        q: Angles [rad], (n,).
        v: Velocities [rad/s], (n,).
        a: Accelerations [rad/s²], (n,).
    """
    pinocchio, n = model.pinocchio, model.n
    data = pinocchio.createData()
    at = configuration(pinocchio, q[None])[0]
    tau = pin.rnea(pinocchio, data, at, v, a)
    by_q, by_v, upper = pin.computeABADerivatives(pinocchio, data, at, v, tau)
    inverse = np.triu(upper) + np.triu(upper, 1).T
    A, B = np.zeros((2 * n, 2 * n)), np.zeros((2 * n, n))
    A[:n, n:] = np.eye(n)
    A[n:, :n] = by_q - inverse * model.spring_rate(q)
    A[n:, n:] = by_v - inverse * model.viscous
    B[n:] = inverse
    return Linear(A, B)


def discretise(continuous: Linear, period: float) -> Linear:
    """Sample with the torque held over each period [s]."""
    A, B = continuous
    sampled = scipy.signal.cont2discrete((A, B, np.eye(len(A)), np.zeros_like(B)), period)
    return Linear(*sampled[:2])
