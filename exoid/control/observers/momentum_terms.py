"""Generalised momentum of a leg and the torques that change it, at one sample or over a whole log."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.control.model import ControlModel
from exoid.errors import ExoidError
from exoid.leg.leg import Leg
from exoid.leg.model import configuration

SLOW = 0.05
"""Velocity at which the level of dry friction is read [rad/s]."""


class Momentum(NamedTuple):
    """Momentum and torques of the model, (n,) or (N, n) each.

    Attributes:
        p: Generalised momentum M(q) v [N·m·s].
        model: Torque of the model that changes it, Cᵀv − G − springs − friction [N·m].
        unknown: Largest error of the friction, where the joint may stick [N·m].
        M: Mass matrix [kg·m²], (n, n) or (N, n, n).
    """

    p: FloatArray
    model: FloatArray
    unknown: FloatArray
    M: FloatArray


@dataclass(frozen=True, eq=False)
class MomentumTerms:
    """Terms of ṗ = τ + τ_wearer + Cᵀv − G(q) − s(q) − r(v), with p = M(q) v.

    Cᵀv = Ṁv − Cv is the derivative of the kinetic energy by the angles (De Luca and Mattone 2003). One sample takes it
    from Pinocchio's Coriolis matrix. Many samples take it from the torque c(v) = RNEA(q, v, 0) − G, a quadratic form of
    v, by (Cᵀv)_i = ½ vᵀ[c(v + e_i) − c(v) − c(e_i)].

    Friction is c0 tanh(v / w) + d v and so on. Where |v| is not large against w the joint may stick, and friction is
    anything between ± the static friction F_s. Its error is then at most F_s (1 − tanh²(v / w)), which falls to 7 % of
    F_s at |v| = 2 w and to 1 % at 3 w.

    Attributes:
        model: Rigid bodies, springs, friction and rotors.
        width: Width w of the smooth sign [rad/s].
        stiction: Static friction over friction in slow motion.

    Raises:
        ExoidError: A term has an inertia that depends on the angles, or a number is not positive.
    """

    model: ControlModel
    width: float
    stiction: float

    def __post_init__(self) -> None:
        """Check the terms."""
        if not (0.0 < self.width < np.inf and 0.0 <= self.stiction < np.inf):
            raise ExoidError(
                f"width {self.width:g} rad/s, stiction {self.stiction:g}", remedy="give finite numbers, width > 0"
            )
        poses = np.random.default_rng(0).uniform(-1.0, 1.0, (4, self.model.n))
        rotors = self.model.rotors(poses)
        if not np.allclose(rotors, rotors[0], rtol=1e-9, atol=1e-12):
            raise ExoidError(
                "a term of the model has an inertia that depends on the angles",
                remedy="make the observer of an estimate without that term",
            )

    def at(self, q: FloatArray, v: FloatArray) -> Momentum:
        """Evaluate the terms at one sample.

        Args:
            q: Angles [rad], (n,).
            v: Velocities [rad/s], (n,).

        Returns:
            The terms, (n,).
        """
        model, data = self._pinocchio
        position = configuration(model, q[None])[0] if model.nq != model.nv else q
        M = pin.crba(model, data, position)
        M = np.triu(M) + np.triu(M, 1).T + self._rotors
        turned = pin.computeCoriolisMatrix(model, data, position, v).T @ v
        torque = turned - self.model.statics(q) - self.model.friction(q, v, self.width)
        return Momentum(M @ v, torque, self._unknown(q[:, None], v[:, None])[:, 0], M)

    def over(self, q: FloatArray, v: FloatArray) -> Momentum:
        """Evaluate the terms at many samples, without a loop over them.

        Args:
            q: Angles [rad], (N, n).
            v: Velocities [rad/s], (N, n).

        Returns:
            The terms, (N, n).
        """
        still = np.zeros_like(q)
        units = np.eye(q.shape[1])
        G, c = self._bodies(q, still, still), self._bodies(q, v, still)
        M = np.stack([self._bodies(q, still, still + unit) - G for unit in units], axis=2) + self._rotors
        turned = np.empty_like(q)
        for i, unit in enumerate(units):
            mixed = self._bodies(q, v + unit, still) - c - self._bodies(q, still + unit, still) + G
            turned[:, i] = 0.5 * np.einsum("nj,nj->n", v, mixed)
        friction = self.model.friction(q.T, v.T, self.width).T
        torque = turned - self.model.statics(q.T).T - friction
        return Momentum(np.einsum("nij,nj->ni", M, v), torque, self._unknown(q.T, v.T).T, M)

    def _bodies(self, q: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        """RNEA of the leg's bodies, (N, n)."""
        leg = self._leg
        out = np.zeros((len(leg.parameter_names), *q.T.shape))
        leg.fill_regressor(q, v, a, out)
        return np.asarray(np.tensordot(leg.parameters, out, axes=1).T)

    def _unknown(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """Bound of the friction's error, (n, N)."""
        slow = np.full_like(v, SLOW)
        level = np.maximum(np.abs(self.model.friction(q, slow, 0.0)), np.abs(self.model.friction(q, -slow, 0.0)))
        return np.asarray(self.stiction * level * (1.0 - np.tanh(v / self.width) ** 2))

    @property
    def _leg(self) -> Leg:
        return self.model.leg

    @cached_property
    def _rotors(self) -> FloatArray:
        return np.asarray(self.model.rotors(np.zeros((1, self.model.n)))[0])

    @cached_property
    def _pinocchio(self) -> tuple[pin.Model, pin.Data]:
        """Bodies without rotors, whose inertia :attr:`_rotors` adds."""
        model = self.model.leg.model
        return model, model.createData()
