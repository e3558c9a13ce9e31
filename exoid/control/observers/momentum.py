"""Generalised momentum of a leg, and the torques that change it, with their columns by the parameters."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.control.friction import WIDTH
from exoid.control.model import ControlModel
from exoid.errors import NotSupportedError
from exoid.estimate import Estimate
from exoid.tools.numbers import checked
from exoid.torques import Motion
from exoid.torques.terms import SIGN_WIDTH


class Momentum(NamedTuple):
    """Momentum and torques of N samples: those of the model in row 0, their derivatives by K parameters behind."""

    p: FloatArray  # generalised momentum M(q) v [N·m·s], (N, 1 + K, n)
    u: FloatArray  # torque of the model that changes it, Cᵀv − G − springs − friction [N·m], (N, 1 + K, n)
    unknown: FloatArray  # largest error of the friction, where the joint may stick [N·m], (N, n)
    M: FloatArray  # mass matrix [kg·m²], (N, n, n)


@dataclass(frozen=True, eq=False)
class MomentumModel:
    """Terms of ṗ = τ + τ_wearer + Cᵀv − G(q) − s(q) − r(v), with p = M(q) v."""

    # Cᵀv = Ṁv − Cv is the derivative of the kinetic energy by the angles (De Luca and Mattone 2003). With the torque
    # c(v) = RNEA(q, v, 0) − G, a quadratic form of v, polarisation gives it without a Coriolis matrix:
    #
    #     (Cᵀv)_i = ¼ vᵀ [c(v + e_i) − c(v − e_i)].
    #
    # Columns of the bodies go the same way. With W(q, v, a) the columns of the other terms, those of the momentum are
    # W(q, 0, v) − W(q, 0, 0), and those of the torque −W(q, v, 0).
    #
    # Friction is c0 tanh(v / w) + d v and so on. Where |v| is not large against w the joint may stick, and friction is
    # anything between ± the static friction F_s. Its error is then at most F_s (1 − tanh²(v / w)), which falls to 7 %
    # of F_s at |v| = 2 w and to 1 % at 3 w.

    model: ControlModel  # rigid bodies, springs, friction and rotors
    width: float  # width w of the smooth sign [rad/s]
    stiction: float  # static friction over friction in slow motion
    estimate: Estimate | None = None  # estimate whose parameters have columns; None for none

    def __post_init__(self) -> None:
        """Check the terms."""
        checked(self.width, "width", above=0.0)
        checked(self.stiction, "stiction", least=0.0)
        rotors = self.model.rotors(np.random.default_rng(0).uniform(-1.0, 1.0, (4, self.model.n)))
        if not np.allclose(rotors, rotors[0], rtol=1e-9, atol=1e-12):
            what = "a term of the model has an inertia that depends on the angles"
            raise NotSupportedError(what, remedy="make the observer of an estimate without that term")

    def over(self, q: FloatArray, v: FloatArray) -> Momentum:
        """Evaluate the terms at samples (N, n)."""
        values, model = self.model.leg.parameters, self.model
        mass, turned, gravity = self._of_bodies(q, v)
        M = np.tensordot(values, mass, axes=1).transpose(2, 0, 1) + self.model.rotors(np.zeros((1, q.shape[1])))[0]
        torque = values @ (turned - gravity).transpose(2, 0, 1)
        torque = torque - model.springs(q.T).T - model.friction(q.T, v.T, self.width).T
        momentum, torques = np.einsum("nij,nj->ni", M, v)[:, None], torque[:, None]
        if self.estimate is not None:
            still, rigid = np.zeros_like(q), len(values)
            motion = (np.tile(q, (3, 1)), np.vstack([still, v, still]), np.vstack([v, still, still]))
            band = self.estimate.band_model
            states = {(j, x): np.tanh(motion[1][:, j] / (SIGN_WIDTH * model.radian[j])) for j, x in band.states}
            pushed, moving, rest = np.split(band.columns(Motion(*motion, states=states)).transpose(2, 0, 1), 3)
            of_torque = -moving
            of_torque[:, :rigid] = (turned - gravity).transpose(2, 0, 1)
            momentum = np.concatenate([momentum, pushed - rest], axis=1)
            torques = np.concatenate([torques, of_torque], axis=1)
        width, slow = self.width * model.radian, WIDTH * model.radian[:, None]
        level = np.max([np.abs(model.friction(q.T, 0.0 * v.T + s * slow, 0.0)) for s in (1.0, -1.0)], axis=0).T
        return Momentum(momentum, torques, self.stiction * level * (1.0 - np.tanh(v / width) ** 2), M)

    def _of_bodies(self, q: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Columns of M(q), (p, n, n, N), and of Cᵀv and G, (p, n, N) each."""
        (count, n), leg, units, still = q.shape, self.model.leg, np.eye(q.shape[1]), np.zeros_like(q)
        speeds = [*(v + unit for unit in units), *(v - unit for unit in units), *[still] * (n + 1)]
        pushes = [*[still] * 2 * n, *(still + unit for unit in units), still]
        table = np.zeros((len(leg.parameter_names), n, len(speeds) * count))
        leg.fill_regressor(np.tile(q, (len(speeds), 1)), np.vstack(speeds), np.vstack(pushes), table)
        columns = table.reshape(*table.shape[:2], len(speeds), count)
        gravity, differences = columns[:, :, -1], columns[:, :, :n] - columns[:, :, n : 2 * n]
        mass = columns[:, :, 2 * n : -1] - gravity[:, :, None]
        return mass, 0.25 * np.einsum("nj,kjin->kin", v, differences), gravity
