"""The model inside a control law: rigid bodies, springs, friction and rotors of one leg, quick at a single sample."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.leg import Leg
from exoid.model import configuration
from exoid.rig import Plant
from exoid.rig.plant import STIFFNESS_DEGREE
from exoid.torques import Armature, Coulomb, JointMotion, Offset, Stiffness, Term, TorqueModel, Viscous

from .law import spread

PLAIN: tuple[type[Term], ...] = (Coulomb, Viscous, Armature)
"""Terms of one coefficient a joint."""


SLIDING = 0.02
"""Velocity over which a contact with a memory changes its sign in a law [rad/s]."""


class OtherTerm(NamedTuple):
    """A term of a kind that this room has no closed form for, at one joint.

    Attributes:
        term: The term.
        joint: Its index.
        values: Of its parameters.
    """

    term: Term
    joint: int
    values: FloatArray

    def torque(self, q: FloatArray, v: FloatArray, load: FloatArray) -> FloatArray:
        """Torque at angles, velocities and gravity torques of its joint [N·m], (N,) each.

        A law does not know the way since the last reversal: a contact that bends counts as one that slides.
        """
        out = np.zeros((len(self.values), q.size))
        sliding = None if self.term.internal_state is None else np.tanh(v / SLIDING)
        self.term.fill(JointMotion(q, v, np.zeros_like(q), load, sliding), out)
        return np.asarray(self.values @ out)


@dataclass(frozen=True, eq=False)
class ControlModel:
    """τ = RNEA(q, v, a) + Ia a + s(q) + r(v): what laws compensate; made by :meth:`of`.

    Methods take (n,) or (n, B) and return the same shape.

    Attributes:
        leg: The rigid bodies.
        spring: Coefficients of s(q), polynomials of each joint, highest power first, offsets included, (D, n).
        coulomb: Coulomb friction [N·m], (n,).
        viscous: Viscous friction [N·m·s/rad], (n,).
        armature: Rotor inertia that is not part of the bodies [kg·m²], (n,).
        others: Terms beside these.
    """

    leg: Leg
    spring: FloatArray
    coulomb: FloatArray
    viscous: FloatArray
    armature: FloatArray
    others: tuple[OtherTerm, ...] = field(default=())

    @classmethod
    def of(cls, source: ModelSource) -> ControlModel:
        """Take over the model of an estimate, a leg (bodies only), or the truth of a plant of one rig.

        Raises:
            ExoidError: The source is none of these, or a plant of several rigs.
        """
        if isinstance(source, ControlModel):
            return source
        if isinstance(source, Estimate):
            return cls.of_parameters(source.model, source.values)
        if isinstance(source, Leg):
            nothing = np.zeros(len(source.joint_names))
            return cls(source, nothing[None], nothing, nothing, nothing)
        if isinstance(source, Plant) and source.count == 1:
            bodies = source.leg.with_parameters(source.parameters[:, 0])
            b = source.stiffness[..., 0]
            return cls(bodies, b, source.coulomb[:, 0], source.viscous[:, 0], source.armature[:, 0])
        what = f"a plant of {source.count} rigs" if isinstance(source, Plant) else repr(source)
        raise ExoidError(f"no control model from {what}", remedy="give an Estimate, a Leg, or a Plant of one rig")

    @classmethod
    def of_parameters(cls, model: TorqueModel, parameters: FloatArray) -> ControlModel:
        """Take over a leg and the terms beside it, with parameters in the order of the model's names, (P,)."""
        return _of_parameters(model.loaded_by(parameters), parameters)

    def plant(self, *, end_stops: bool = True) -> Plant:
        """Build the rig that this model describes; friction that is negative, which no rig can have, becomes zero.

        Args:
            end_stops: Whether joints stop at the limits of the URDF.

        Raises:
            ExoidError: There are terms that a rig does not have, or no bodies have such parameters.
        """
        if self.others or len(self.spring) > STIFFNESS_DEGREE + 1:
            raise ExoidError(
                "the rig has no such friction or stiffness",
                remedy=f"identify Coulomb and viscous friction, and stiffness of degree {STIFFNESS_DEGREE} at most",
            )
        powers = range(len(self.spring) - 1, -1, -1)
        rows = {f"b{power}": row for power, row in zip(powers, self.spring, strict=True)}
        rows |= {"c0": self.coulomb.clip(0.0), "d": self.viscous.clip(0.0), "Ia": self.armature.clip(0.0)}
        labels = self.leg.joint_labels
        values = {
            f"{symbol}_{label}": float(x) for symbol, row in rows.items() for label, x in zip(labels, row, strict=True)
        }
        return Plant.build(self.leg, values, end_stops=end_stops)

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.coulomb)

    def statics(self, q: FloatArray) -> FloatArray:
        """Torque that holds the leg at q: gravity, springs and offsets [N·m]."""
        if q.ndim == 1:
            return np.asarray(self.gravity(q) + self._springs(q))
        return self.inverse_dynamics(q, np.zeros_like(q), np.zeros_like(q))

    def gravity(self, q: FloatArray) -> FloatArray:
        """Gravity torque of the bodies [N·m]."""
        if q.ndim == 2:
            return self.leg.gravity(q.T).T
        at = configuration(self.pinocchio, q[None])[0] if self._turns else q
        return np.asarray(pin.computeGeneralizedGravity(self.pinocchio, self._data, at))

    def inverse_dynamics(self, q: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        """RNEA(q, v, a) + Ia a + s(q): everything but friction [N·m]."""
        if q.ndim == 1:
            at = configuration(self.pinocchio, q[None])[0] if self._turns else q
            return np.asarray(pin.rnea(self.pinocchio, self._data, at, v, a) + self._springs(q))
        leg = self.leg
        if leg.chain is not None:
            torque = (leg.regressor(q.T, v.T, a.T) @ leg.parameters).T
        else:
            torque = leg.inverse_dynamics(q.T, v.T, a.T).T
        return np.asarray(torque + self.armature[:, None] * a + self._springs(q))

    def friction(self, q: FloatArray, v: FloatArray, width: float) -> FloatArray:
        """r(v) = c0 sgn v + d v, or c0 tanh(v / width) + d v, and whatever else depends on velocity [N·m].

        Args:
            q: Angles [rad], for terms that depend on them too.
            v: Velocities [rad/s].
            width: Over which the sign changes [rad/s]; 0 for a sharp one.
        """
        sign = np.sign(v) if width == 0.0 else np.tanh(v / width)
        torque = spread(self.coulomb, v) * sign + spread(self.viscous, v) * v
        if self.others:
            load = self.gravity(q)
            for other in self.others:
                at, rate, pull = (np.atleast_1d(x[other.joint]) for x in (q, v, load))
                moving = other.torque(at, rate, pull) - other.torque(at, np.zeros_like(rate), pull)
                torque[other.joint] += moving.reshape(v.shape[1:])
        return np.asarray(torque)

    def spring_rate(self, q: FloatArray) -> FloatArray:
        """s'(q) of the polynomials [N·m/rad], (n,); q is (n,)."""
        powers = np.arange(len(self.spring) - 1, 0, -1.0)[:, None]
        return np.asarray((powers * self.spring[:-1] * q ** (powers - 1.0)).sum(axis=0))

    def mass_matrix(self, q: FloatArray) -> FloatArray:
        """M(q) with rotors [kg·m²], (n, n); q is (n,)."""
        return np.asarray(self.leg.mass_matrix(q)[0] + np.diag(self.armature))

    def with_friction(self, scale: float) -> ControlModel:
        """Return the same model with other friction: ``scale`` times as large."""
        others = tuple(other._replace(values=scale * other.values) for other in self.others)
        return replace(self, coulomb=scale * self.coulomb, viscous=scale * self.viscous, others=others)

    @cached_property
    def pinocchio(self) -> pin.Model:
        """The bodies with rotors, for Pinocchio's algorithms."""
        model = self.leg.model.copy()
        model.armature[:] += self.armature
        return model

    @cached_property
    def _data(self) -> pin.Data:
        return self.pinocchio.createData()

    @cached_property
    def _turns(self) -> bool:
        return bool(self.pinocchio.nq != self.pinocchio.nv)

    def _springs(self, q: FloatArray) -> FloatArray:
        """Horner's scheme."""
        first, *rest = self.spring if q.ndim == 1 else self.spring[..., None]
        torque = first
        for coefficient in rest:
            torque = torque * q + coefficient
        for other in self.others:
            at = np.atleast_1d(q[other.joint])
            torque = torque + np.zeros_like(q)
            torque[other.joint] += other.torque(at, np.zeros_like(at), np.zeros_like(at)).reshape(q.shape[1:])
        return np.asarray(torque)


ModelSource = Estimate | Leg | Plant | ControlModel
"""What laws know of a leg: an estimate, a leg (its bodies only), or the truth of a plant of one rig."""


def _of_parameters(model: TorqueModel, parameters: FloatArray) -> ControlModel:
    leg = model.leg.with_parameters(parameters[: len(model.leg.parameter_names)])
    values = dict(zip(model.names, parameters.tolist(), strict=True))
    n = len(leg.joint_names)
    degree = max((term.degree for term in model.terms if type(term) is Stiffness), default=0)
    spring, rest = np.zeros((degree + 1, n)), np.zeros((3, n))
    others = []
    for term in model.terms:
        for joint in term.joint_indices(leg.joint_names, leg.joint_labels):
            # what is regrouped into another parameter is compensated there
            found = np.array([values.get(f"{symbol}_{leg.joint_labels[joint]}", 0.0) for symbol in term.symbols])
            kind = type(term)
            if type(term) is Stiffness:  # a type derived from it may compute something else
                spring[degree - term.degree :, joint] += found
            elif kind is Offset:
                spring[-1, joint] += found[0]
            elif kind in PLAIN and len(term.symbols) == 1:
                rest[PLAIN.index(kind), joint] += found[0]
            else:
                others.append(OtherTerm(term, joint, found))
    coulomb, viscous, armature = rest
    return ControlModel(leg, spring, coulomb, viscous, armature, tuple(others))
