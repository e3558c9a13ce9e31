"""Linearised dynamics of many legs at a pose: of a control model, or of draws of the parameters of an estimate."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.control.model import ControlModel
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
