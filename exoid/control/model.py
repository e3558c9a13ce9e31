"""Model inside a controller: rigid bodies, springs, friction and rotors of one leg, fast at a single sample."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import pinocchio as pin

from exoid._typing import ArrayLike, BoolArray, FloatArray
from exoid.errors import BadArgumentError, NotIdentifiableError, NotSupportedError
from exoid.estimate import Estimate
from exoid.leg.leg import Leg
from exoid.leg.leg_data import refuse_floating_base
from exoid.leg.lift.pseudo_inertia import make_consistent, pseudo_inertias
from exoid.leg.model import configuration
from exoid.regression.diagnostics import SIZE
from exoid.regression.residuals import matrix_root
from exoid.rig import Plant
from exoid.rig.plant import STIFFNESS_DEGREE
from exoid.tools.numbers import checked
from exoid.torques import Armature, Coulomb, Offset, Stiffness, Term, TorqueModel, Viscous
from exoid.torques.catalog import radians

from .law import RATE
from .other_term import OtherTerm, torque_of


@dataclass(frozen=True, eq=False)
class ControlModel:
    """Model that controllers compensate, τ = RNEA(q, v, a) + Ia a + s(q) + r(v); made by :meth:`of`.

    Methods accept (n,) or (n, B) and return the same shape.

    Attributes:
        leg: Rigid bodies.
        spring: Coefficients of s(q), one polynomial for each joint, highest power first, with offsets, (D, n).
        coulomb: Coulomb friction [N·m], (n,).
        viscous: Viscous friction [N·m·s/rad], (n,).
        armature: Rotor inertia that is not part of the bodies [kg·m²], (n,).
        others: Other terms.
        passive: Joints without an actuator, which get no torque from any law.

    Raises:
        ExoidError: The base of the leg floats.
    """

    leg: Leg
    spring: FloatArray
    coulomb: FloatArray
    viscous: FloatArray
    armature: FloatArray
    others: tuple[OtherTerm, ...] = field(default=())
    passive: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Check the base."""
        refuse_floating_base(self.leg, "control")

    @classmethod
    def of(cls, source: ModelSource) -> ControlModel:
        """Make the model of an estimate, a leg or a plant.

        Args:
            source: An estimate, a leg (bodies only), a plant of one rig (its true parameters), or such a model. See
                :func:`completed` for parameters that an estimate does not determine.

        Returns:
            The model.

        Raises:
            ExoidError: The source is none of these, or a plant of several rigs.

        Warns:
            UserWarning: Parameters of the estimate are not determined, or its findings have errors.
        """
        if isinstance(source, ControlModel):
            return source
        if isinstance(source, Estimate):
            known = completed(source)
            found = zip(source.names, source.identifiability, source.values, known.values, strict=True)
            open_ = [f"{name} = {new:.3g}" for name, kind, old, new in found if kind == "not" and abs(new - old) > 1e-9]
            if open_:
                what = "not determined by the recordings, and used with values near the leg as it was given and near"
                warnings.warn(f"{what} zero for friction and offsets: {', '.join(open_)}", UserWarning, stacklevel=2)
            return replace(cls.of_parameters(source.model, known.values), passive=source.passive)
        if isinstance(source, Leg):
            nothing = np.zeros(len(source.joint_names))
            return cls(source, nothing[None], nothing, nothing, nothing)
        if isinstance(source, Plant) and source.count == 1:
            bodies = source.leg.with_parameters(source.parameters[:, 0])
            b = source.stiffness[..., 0]
            return cls(bodies, b, source.coulomb[:, 0], source.viscous[:, 0], source.armature[:, 0])
        what = f"a plant of {source.count} rigs" if isinstance(source, Plant) else repr(source)
        raise BadArgumentError(f"no control model from {what}", remedy="give an Estimate, a Leg, or a Plant of one rig")

    @classmethod
    def of_parameters(cls, model: TorqueModel, parameters: FloatArray) -> ControlModel:
        """Make the model of a leg and its terms.

        Args:
            model: Leg and terms.
            parameters: Parameters in SI units, in the order of ``model.names``, (P,).

        Returns:
            The model.
        """
        model = model.loaded_by(parameters)
        leg = model.leg.with_parameters(parameters[: len(model.leg.parameter_names)])
        values = dict(zip(model.names, parameters.tolist(), strict=True))
        n = len(leg.joint_names)
        degree = max((term.degree for term in model.terms if type(term) is Stiffness), default=0)
        plain: tuple[type[Term], ...] = (Coulomb, Viscous, Armature)
        spring, rest = np.zeros((degree + 1, n)), np.zeros((3, n))
        others = []
        for term, joints, names in model.blocks:
            joint, kind = joints[0], type(term)
            found = np.array([values.get(name, 0.0) for name in names])  # a regrouped one is part of another
            if type(term) is Stiffness:  # a subclass may compute something else
                spring[degree - term.degree :, joint] += found
            elif kind is Offset:
                spring[-1, joint] += found[0]
            elif kind in plain:
                rest[plain.index(kind), joint] += found[0]
            else:
                others.append(OtherTerm.of(term, joints, found, radians(leg)))
        coulomb, viscous, armature = rest
        return cls(leg, spring, coulomb, viscous, armature, tuple(others))

    def plant(self, *, end_stops: bool = True) -> Plant:
        """Build the rig that this model describes. A rig cannot have negative friction, which becomes zero.

        Args:
            end_stops: Whether joints stop at the limits of the URDF.

        Returns:
            One rig.

        Raises:
            ExoidError: The model has terms that a rig does not have, or no bodies have such parameters.
        """
        if self.others or len(self.spring) > STIFFNESS_DEGREE + 1:
            remedy = f"identify Coulomb and viscous friction, and stiffness of degree {STIFFNESS_DEGREE} at most"
            raise NotSupportedError("the rig has no such friction or stiffness", remedy=remedy)
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

    def driven(self, values: FloatArray) -> FloatArray:
        """Set what belongs to passive joints to zero.

        Args:
            values: One for each joint in the first axis, such as torques [N·m], (n, ...).

        Returns:
            The same, zero at joints without an actuator.
        """
        return np.where(self.drives.reshape(-1, *(1,) * (values.ndim - 1)), values, 0.0) if self.passive else values

    def statics(self, q: FloatArray) -> FloatArray:
        """Compute the torque that holds the leg at q: gravity, springs and offsets.

        Args:
            q: Angles [rad], (n,) or (n, B).

        Returns:
            Torque [N·m], of the same shape.
        """
        return np.asarray(self.gravity(q) + self.springs(q))

    def gravity(self, q: FloatArray) -> FloatArray:
        """Compute the gravity torque of the bodies.

        Args:
            q: Angles [rad], (n,) or (n, B).

        Returns:
            Torque [N·m], of the same shape.
        """
        if q.ndim == 1 and self.leg.closure is not None:
            return np.array(self.leg.gravity(q)[0])
        if q.ndim == 1:
            return np.array(pin.computeGeneralizedGravity(self.pinocchio, self._data, self._configuration(q)))
        still = np.zeros_like(q)
        return self._bodies(q, still, still)

    def inverse_dynamics(self, q: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        """Compute RNEA(q, v, a) + Ia a + s(q): all torques except friction.

        Args:
            q: Angles [rad], (n,) or (n, B).
            v: Velocities [rad/s], likewise.
            a: Accelerations [rad/s²], likewise.

        Returns:
            Torque [N·m], of the same shape.
        """
        torque = self._bodies(q, v, a) + self.springs(q)
        return np.asarray(torque + self._others_beyond_rest(q, a=a) if self._inertial else torque)

    def friction(self, q: FloatArray, v: FloatArray, width: float) -> FloatArray:
        """Compute r(v) = c0 sgn v + d v, or c0 tanh(v / width) + d v, and other terms that depend on velocity.

        The load of friction that grows with it is gravity: laws do not know the acceleration.

        Args:
            q: Angles [rad], for terms that depend on them too, (n,) or (n, B).
            v: Velocities [rad/s], likewise.
            width: Width of a smooth sign [rad/s], a tenth of it in m/s where a joint slides; 0 for a sharp one.

        Returns:
            Torque [N·m], of the same shape.
        """
        c0, d, radian = (x if v.ndim == 1 else x[:, None] for x in (self.coulomb, self.viscous, self.radian))
        sign = np.sign(v) if width == 0.0 else np.tanh(v / (width * radian))
        torque = c0 * sign + d * v
        return np.asarray(torque + self._others_beyond_rest(q, v=v, load=self.gravity(q)) if self.others else torque)

    def mass_matrix(self, q: FloatArray) -> FloatArray:
        """Compute M(q) with rotors and other terms that depend on accelerations.

        Args:
            q: Angles [rad], (n,).

        Returns:
            Mass matrix [kg·m²], (n, n).
        """
        return np.asarray(self.leg.mass_matrix(q)[0] + self.rotors(q[None])[0])

    def rotors(self, q: FloatArray) -> FloatArray:
        """Compute the part of the mass matrix that is not the bodies': rotors, and other terms with accelerations.

        Args:
            q: Angles [rad], (N, n).

        Returns:
            Inertias [kg·m²], (N, n, n).
        """
        found = np.tile(np.diag(self.armature), (len(q), 1, 1))
        if self._inertial:
            for joint, one in enumerate(np.eye(self.n)):
                found[..., joint] += self._others_beyond_rest(q.T, a=np.tile(one[:, None], len(q))).T
        return found

    @cached_property
    def radian(self) -> FloatArray:
        """What counts as a radian at each joint, 1 rad or 0.1 m, (n,)."""
        return radians(self.leg)

    @cached_property
    def drives(self) -> BoolArray:
        """Whether each joint has an actuator, (n,)."""
        return np.isin(self.leg.joint_names, self.passive, invert=True)

    @cached_property
    def pinocchio(self) -> pin.Model:
        """Bodies with rotors, for Pinocchio's algorithms."""
        if self.leg.closure is not None:
            raise NotSupportedError("this controller takes no closed loops", remedy="docs/loops.md says what does")
        model = self.leg.model.copy()
        model.armature[:] += self.armature
        return model

    @cached_property
    def _data(self) -> pin.Data:
        return self.pinocchio.createData()

    def _configuration(self, q: FloatArray) -> FloatArray:
        """Pinocchio's configuration of one leg, in which a joint without limits is (cos q, sin q)."""
        return q if self.pinocchio.nq == self.pinocchio.nv else configuration(self.pinocchio, q[None])[0]

    @cached_property
    def _inertial(self) -> bool:
        """Whether some other term depends on accelerations."""
        return any(other.inertial for other in self.others)

    def _bodies(self, q: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        """RNEA(q, v, a) + Ia a, of one leg by Pinocchio, of many at once."""
        if q.ndim == 1 and self.leg.closure is not None:
            return np.array(self.leg.inverse_dynamics(q, v, a)[0] + self.armature * a)
        if q.ndim == 1:
            return np.array(pin.rnea(self.pinocchio, self._data, self._configuration(q), v, a))
        leg = self.leg
        rows = (
            leg.inverse_dynamics(q.T, v.T, a.T) if leg.chain is None else leg.regressor(q.T, v.T, a.T) @ leg.parameters
        )
        return np.asarray(rows.T + self.armature[:, None] * a)

    def springs(self, q: FloatArray) -> FloatArray:
        """Compute the torque s(q) of springs and offsets, by Horner's scheme.

        Args:
            q: Angles [rad], (n,) or (n, B).

        Returns:
            Torque [N·m], of the same shape.
        """
        torque, *rest = self.spring if q.ndim == 1 else self.spring[:, :, None]
        for coefficient in rest:
            torque = torque * q + coefficient
        return np.asarray(torque + torque_of(self.others, q) if self.others else torque)

    def _others_beyond_rest(
        self, q: FloatArray, v: FloatArray | None = None, a: FloatArray | None = None, load: FloatArray | None = None
    ) -> FloatArray:
        """What motion adds to the torques of the other terms."""
        return torque_of(self.others, q, v, a, load) - torque_of(self.others, q, load=load)


def possible_mass_matrix(model: ControlModel, pose: FloatArray) -> FloatArray:
    """Mass matrix at a pose; refuse one that no links have: feedback through it would drive the leg away."""
    M = model.mass_matrix(pose)
    if np.linalg.eigvalsh(M)[0] <= 0.0:
        what = f"no links have this mass matrix, with {np.diagonal(M).round(4).tolist()} kg·m² on its diagonal"
        remedy = "look at the findings of the estimate, such as signs of torques, and record faster motion"
        raise NotIdentifiableError(what, where=model.leg.description.name, remedy=remedy)
    return M


def default_gains(source: ModelSource, pose: FloatArray, rate: float = RATE) -> tuple[FloatArray, FloatArray]:
    """Choose Kp = ω² M_ii and Kd = min(2 ω, 1 / (λ T)) M_ii for a natural frequency ω of 5 rad/s at a pose.

    The damping is critical unless the sampling period T allows less: λ is the largest eigenvalue of M⁻¹ diag(M_ii).

    Args:
        source: Source of the model.
        pose: Angles [rad], (n,).
        rate: Sampling rate of the controller [Hz].

    Returns:
        Kp [N·m/rad] and Kd [N·m·s/rad], (n,) each.

    Raises:
        ExoidError: The pose is not that of such a leg, or the rate is not positive.
    """
    checked(rate, "the rate of a controller [Hz]", above=0.0, ndim=0)
    # 5 rad/s is as low as document 2's errors suggest
    M, frequency = ControlModel.of(source).mass_matrix(checked(pose, "the pose")), 5.0
    inertia = np.diagonal(M)
    # a held torque −Kd v is unstable from Kd λ T / M_ii = 2; half of that leaves room for late readings
    fastest = float(np.linalg.eigvals(np.linalg.solve(M, np.diag(inertia))).real.max())
    return frequency**2 * inertia, min(2.0 * frequency, rate / fastest) * inertia


ModelSource = Estimate | Leg | Plant | ControlModel
"""Source of a controller's model: an estimate, a leg (bodies only), or a plant of one rig (its true parameters)."""


def completed(source: Estimate) -> Estimate:
    """Take what an estimate does not determine from the leg as it was given, friction as zero; warn of its errors."""
    errors = [f"{one.kind} {one.joint}".strip() for one in source.findings if one.severity == "error"]
    if errors:
        what = "the estimate has errors, and so has a law that is made of it; its findings say what to mend"
        warnings.warn(f"{what}: {', '.join(errors)}", UserWarning, stacklevel=3)
    free = np.flatnonzero((np.array(source.identifiability) == "not") & (source.std > 0.0))
    if len(free) == len(source.names):
        what, where = "the recordings determine no parameter: a law would compensate noise", source.leg.description.name
        remedy = "identify with a longer or faster log, or give the leg itself (exoid.Leg) as the model"
        raise NotIdentifiableError(what, where=where, remedy=remedy, parameters=source.names)
    # springs and friction of a passive joint stay: without a measured torque nothing says what size they could have
    size = SIZE * np.minimum(source.parameter_scale, source.reference_scale)
    free = free[size[free] > 0.0]
    if not len(free):
        return source
    # Bayes' rule with a prior of these alone. It is as wide as a CAD model may be wrong, not as all torque of the log:
    # where joints stick, friction looks like ten times the gravity. Combinations that the log determines stay.
    leg, count = source.model.leg, len(source.model.leg.parameters)
    given = np.zeros(len(source.names))
    given[:count] = leg.parameters
    prior = np.diag(size**2)
    bodies = payload_covariance(leg, 0.3 * leg.link_parameters.reshape(-1, 10)[:, 0])  # masses are 30 % wrong
    prior[:count, :count] = bodies + 0.1 * np.diag(np.diag(bodies))  # point masses alone have a singular one in space
    C, apart, among = source.covariance, (given - source.values)[free], np.ix_(free, free)
    # Where both contradict each other (χ² over its mean of 1), errors of the model are not in the covariance C
    for _ in range(40):  # a singular one cannot agree
        C = C * (1.0 + (apart @ np.linalg.solve(C[among] + prior[among], apart) > len(free)))
    gain = np.linalg.solve(C[among] + prior[among], C[free]).T
    left = np.eye(len(C))
    left[:, free] -= gain
    # (1 − K) C (1 − K)ᵀ + K P Kᵀ, by Joseph: a difference of large variances, C − K C, would leave negative ones
    half = np.hstack([left @ matrix_root(C), gain @ matrix_root(prior[among])])
    half[source.std == 0.0] = 0.0
    return replace(source, values=source.values + gain @ apart, covariance=half @ half.T)


def payload_covariance(leg: Leg, payload: ArrayLike) -> FloatArray:
    """Covariance of changes of the leg's parameters by masses [kg] on the links, distributed like their own, (p, p)."""
    changes, links = [], pseudo_inertias(make_consistent(leg.link_parameters))
    directions = np.vstack([np.zeros(3), np.eye(3), -np.eye(3)]) * np.sqrt(3.5)  # seven places with unit variance
    for link, (P, mass) in enumerate(zip(links, np.broadcast_to(payload, len(links)), strict=True)):
        centre = P[:3, 3] / P[3, 3]
        squares, axes = np.linalg.eigh(P[:3, :3] / P[3, 3] - np.outer(centre, centre))
        places = centre + directions @ (axes * np.sqrt(squares)).T
        bodies = [pin.Inertia(1.0, place, np.zeros((3, 3))).toDynamicParameters() for place in places]
        collected = leg.reduction.collect[:, 10 * link : 10 * link + 10] @ np.transpose(bodies)
        changes.append(mass / np.sqrt(len(places)) * collected)
    change = np.hstack(changes)
    return np.asarray(change @ change.T)
