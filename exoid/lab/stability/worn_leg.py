"""Worn legs linearised at a pose, alone and with a wearer, and over one sampling period."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import ArrayLike, FloatArray
from exoid.control.model import ControlModel
from exoid.errors import BadArgumentError
from exoid.rig import Wearer
from exoid.torques import TorqueModel

SPEED = 0.5
"""Speed about which friction is linearised [rad/s], ten times the width of a smooth sign."""

STEP = 1e-5
"""Step of central differences [rad, rad/s]; functions of angle and velocity are smooth there."""


class LinearLeg(NamedTuple):
    """B legs linearised at a pose, M δa + D δv + K δq = δτ."""

    # Coulomb friction has no slope while a joint moves. D is therefore the mean of the slopes at +0.5 and −0.5 rad/s
    # of all joints, in which Coriolis torques cancel.

    M: FloatArray  # mass matrices with rotors [kg·m²], (B, n, n)
    D: FloatArray  # damping [N·m·s/rad], (B, n, n)
    K: FloatArray  # stiffness of gravity and springs [N·m/rad], (B, n, n)


def linear_leg(model: ControlModel, q: FloatArray) -> LinearLeg:
    """Linearise one model."""
    around = _Neighbours.of(q)
    at, rate, still = (x.T for x in around)
    torque = model.inverse_dynamics(at, rate, still) + model.friction(at, rate, 0.0)
    D, K = around.slopes(torque.T[..., None])
    return LinearLeg(model.mass_matrix(q)[None], D, K)


def linear_legs(model: TorqueModel, parameters: FloatArray, q: FloatArray) -> LinearLeg:
    """Linearise a leg with each of many sets of parameters; the torque is linear in them."""
    around = _Neighbours.of(q)
    D, K = around.slopes(model.regressor(*around) @ parameters.T)
    return LinearLeg(mass_matrices(model, parameters, q[None])[0], D, K)


def mass_matrices(model: TorqueModel, parameters: FloatArray, poses: FloatArray) -> FloatArray:
    """Compute mass matrices, rotors included, from the regressor."""
    count, n = poses.shape
    q = np.repeat(poses, n + 1, axis=0)
    a = np.tile(np.vstack([np.zeros(n), np.eye(n)]), (count, 1))
    W = model.regressor(q, np.zeros_like(q), a).reshape(count, n + 1, n, -1)
    columns = (W[:, 1:] - W[:, :1]) @ parameters.T  # (N, n of a, n of τ, B)
    M = columns.transpose(0, 3, 2, 1)
    return np.asarray(0.5 * (M + np.swapaxes(M, 2, 3)))


class LinearWearer(NamedTuple):
    """Limb of a wearer, M δa + D δv + K δq = −δτ_wearer, with muscles that hold it near its intention."""

    # The torque on the leg is δτ_wearer = k (δq_limb − δq) + d (δv_limb − δv).

    M: FloatArray  # mass matrix of the limb [kg·m²], (n, n)
    D: FloatArray  # damping by muscles [N·m·s/rad], (n, n)
    K: FloatArray  # stiffness of gravity and muscles [N·m/rad], (n, n)
    stiffness: FloatArray  # stiffness k of the cuffs [N·m/rad], (n,)
    damping: FloatArray  # damping d of the cuffs [N·m·s/rad], (n,)


def linear_wearer(wearer: Wearer, q: FloatArray) -> LinearWearer:
    """Linearise a wearer."""
    if len(q) != len(wearer.limb.joint_names):
        raise BadArgumentError(
            f"a wearer with {len(wearer.limb.joint_names)} joints in a leg with {len(q)}",
            remedy="make the wearer of the same leg, Wearer.build(leg)",
        )
    M, D, K = (each[0] for each in linear_leg(ControlModel.of(wearer.limb), q))
    D = D + np.diag(_each(wearer.muscle_damping, q))
    K = K + np.diag(_each(wearer.muscle_stiffness, q))
    return LinearWearer(M, D, K, _each(wearer.cuff_stiffness, q), _each(wearer.cuff_damping, q))


class HeldLeg(NamedTuple):
    """One sampling period of B worn legs under held torques, x⁺ = A x + B δτ and y = C x."""

    # The state is x = (δq, δv) of the leg, then of the limb.

    A: FloatArray  # state matrices, (B, s, s)
    B: FloatArray  # input matrices, (B, s, n)
    C: FloatArray  # readings (q, v, interaction torque) by state, (3 n, s)

    def take(self, rows: NDArray[np.intp]) -> HeldLeg:
        """Select some legs."""
        return HeldLeg(self.A[rows], self.B[rows], self.C)


def hold(leg: LinearLeg, wearer: LinearWearer | None, period: float) -> HeldLeg:
    """Integrate worn legs exactly over one period of constant torque."""
    count, n, _ = leg.M.shape
    size = 2 * n if wearer is None else 4 * n
    one, inverse = np.eye(n), np.linalg.inv(leg.M)
    C = np.eye(3 * n, size)
    joined = np.zeros((count, size + n, size + n))  # of (x, δτ)
    joined[:, :n, n : 2 * n] = one
    joined[:, n : 2 * n, :n] = -inverse @ leg.K
    joined[:, n : 2 * n, n : 2 * n] = -inverse @ leg.D
    joined[:, n : 2 * n, size:] = inverse
    if wearer is None:
        C[2 * n :] = 0.0
    else:
        limb = np.linalg.inv(wearer.M)
        k, d = np.diag(wearer.stiffness), np.diag(wearer.damping)
        cuffs = np.hstack([-k, -d, k, d])  # δτ_wearer by x
        C[2 * n :] = cuffs
        joined[:, n : 2 * n, :size] += inverse @ cuffs
        joined[:, 2 * n : 3 * n, 3 * n : size] = one
        joined[:, 3 * n : size, 2 * n : 3 * n] = -limb @ wearer.K
        joined[:, 3 * n : size, 3 * n : size] = -limb @ wearer.D
        joined[:, 3 * n : size, :size] -= limb @ cuffs
    held = scipy.linalg.expm(period * joined)
    return HeldLeg(held[:, :size, :size], held[:, :size, size:], C)


class _Neighbours(NamedTuple):
    """Motion around a pose, whose torques give the slopes, (6 n, n) each: forth and back at rest, at +v and at −v."""

    q: FloatArray
    v: FloatArray
    a: FloatArray

    @classmethod
    def of(cls, q: FloatArray) -> _Neighbours:
        """Make the neighbours of the angles (n,) at rest [rad]."""
        steps = STEP * np.vstack([np.eye(len(q)), -np.eye(len(q))])
        still = np.zeros_like(steps)
        at = q + np.vstack([steps, still, still])
        return cls(at, np.vstack([still, SPEED + steps, -SPEED + steps]), np.zeros_like(at))

    def slopes(self, torque: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Damping and stiffness from torques (6 n, n, B), (B, n, n) each."""
        n = self.q.shape[1]
        forth, back = np.moveaxis(torque.reshape(3, 2, n, n, -1), 1, 0)
        by_q, ahead, behind = ((forth - back) / (2.0 * STEP)).transpose(0, 3, 2, 1)
        return 0.5 * (ahead + behind), by_q


def _each(value: ArrayLike, q: FloatArray) -> FloatArray:
    """One number for each joint, (n,)."""
    array = np.asarray(value, dtype=np.float64)
    if array.ndim == 2 and array.shape[1] > 1:
        raise BadArgumentError(
            f"a wearer of {array.shape[1]} rigs", remedy="give a wearer with one number for each joint"
        )
    return np.array(np.broadcast_to(array.reshape(-1), q.shape))
