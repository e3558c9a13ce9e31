"""Whole-body law on the ground: joint and torso motion by inverse dynamics, with forces that the ground can give."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Literal, NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.codegen import Dialect, LawInC
from exoid.control.friction import PASSIVE, FrictionCompensation
from exoid.control.functions import minimum_jerk
from exoid.control.law import State
from exoid.errors import BadArgumentError
from exoid.estimate import Estimate
from exoid.leg.leg import Leg
from exoid.leg.reduction.planar import GRAVITY
from exoid.leg.torso import TorsoMotion
from exoid.rig import Target
from exoid.rig.ground import GroundPlant, Sole
from exoid.tools.numbers import checked

from .in_c import stance_in_c
from .model import BASE, ContactRows, GroundModel
from .qp import YIELDS, Rows, minimise, require_daqp, solutions

ContactKind = Literal["flat", "heel", "toe"]
"""Part of a sole that touches."""

EFFORT, SHARE, DRIFT = 1e-4, 1e-3, 1e-3
"""Square roots of weights beside 1 s²/rad of a joint: of torque [1/(N·m)], force beside its share [1/N], hip [s²/m]."""
# An error of 100 N in the shares costs as much as 0.1 rad/s²: shares yield to motion, and torque yields to shares.

ARM = 0.1
"""Arm by which forces and moments on a sole are compared [m]."""

FADING = 0.05
"""Share, over the largest one, below which a contact fades."""

LEAST_SHARE, LARGEST_SHARE = 0.2, 3.0
"""Least normal force of a contact beside others, and largest one, over the weight and its part of the shares."""
# A foot that bears next to nothing leaves the ground by the law's own doing; one alone bears what the motion asks for.


class GroundState(NamedTuple):
    """Input of a law on the ground at a sample.

    Attributes:
        q: Joint angles [rad], (n,).
        v: Joint velocities [rad/s], (n,).
        pitch: Pitch of the torso against the vertical [rad], positive about −lateral: the shoulders move backwards.
        pitch_rate: Its rate [rad/s].
        contacts: Soles that touch, and the part of each that does, by the name of their link.
        shares: Relative share of the load of each contact, ≥ 0; one that is not named has the share 1.
        interaction: Torque of the wearer on the joints [N·m], (n,); None if unknown.
        push: Known force on the torso, such as that of a crutch, in the rows of the base [N, N, N·m], (3,); None for
            none.
        lean: Angle by which the ground rises forward [rad], for contacts that are not flat.
    """

    q: FloatArray
    v: FloatArray
    pitch: float
    pitch_rate: float
    contacts: Mapping[str, ContactKind]
    shares: Mapping[str, float] = MappingProxyType({})
    interaction: FloatArray | None = None
    push: FloatArray | None = None
    lean: float = 0.0


class GroundTarget(NamedTuple):
    """Reference of joints and torso at a sample.

    Attributes:
        q: Joint angles [rad], (n,).
        v: Joint velocities [rad/s], (n,).
        a: Joint accelerations [rad/s²], (n,); None for zero.
        pitch: Pitch of the torso [rad].
        pitch_rate: Its rate [rad/s].
        pitch_acceleration: Its second derivative [rad/s²].
    """

    q: FloatArray
    v: FloatArray
    a: FloatArray | None = None
    pitch: float = 0.0
    pitch_rate: float = 0.0
    pitch_acceleration: float = 0.0


class StanceCommand(NamedTuple):
    """What the law wants at a sample.

    Attributes:
        torque: Torque of the actuators [N·m], (n,).
        acceleration: Acceleration of hip (forward and up, in the torso's axes), pitch and joints, (3 + n,).
        forces: Force on each sole: along its axes forward and up and the moment about its middle if it is flat, (3,);
            along and across the ground if it is a point, (2,).
        feasible: Whether friction cones, soles and limits allow such forces. Otherwise limits of torque hold, and the
            forces are beyond cone or sole by as little as possible: the machine will slip or tip.
    """

    torque: FloatArray
    acceleration: FloatArray
    forces: Mapping[str, FloatArray]
    feasible: bool


@dataclass(frozen=True, eq=False)
class StanceLaw:
    """Whole-body law on the ground; made by :func:`stance`. It has no memory, but Pinocchio's work memory."""

    model: GroundModel  # rigid bodies, springs and friction
    kp: FloatArray  # gain of angles, of the pitch last [1/s²], (n + 1,)
    kd: FloatArray  # gain of rates [1/s], (n + 1,)
    friction: FrictionCompensation | None  # compensation of friction, which never drives; None for none
    ground_friction: float  # coefficient of friction that the law may use
    limit: FloatArray  # largest torque [N·m], (n,)
    power: FloatArray  # largest power of a joint [W], (n,)
    margin: float  # distance of the centre of pressure from the ends of a sole [m]
    estimate: Estimate | None = None  # estimate, for bands; None if the model is exact
    rate: float = 1000.0  # rate of its C [Hz]; in Python it has none

    def command(self, state: GroundState, target: GroundTarget) -> StanceCommand:
        """Compute torque, accelerations and forces.

        They minimise |A (dν − dν_d)|² + ε |τ|² + |W (f − f_share)|² under M dν + h = Sᵀτ + Jᵀf, J dν = −dJ ν, the
        friction cone, edges of soles, bounds of normal forces by shares, and limits. f_share bears the same load with
        the given shares, f_share = G J_bᵀ f with G = S J_b (J_bᵀ S J_b)⁻¹: only their bounds change the motion.

        Args:
            state: Measured state, with the contacts that hold.
            target: Reference at this moment.

        Returns:
            Torque, accelerations and forces.

        Raises:
            ExoidError: Nothing touches the ground or has a share, or a number is missing.
        """
        _refuse(self.model, state, target)
        shares = {link: float(state.shares.get(link, 1.0)) for link in state.contacts}
        full = self._command(state, target, shares)
        least = FADING * max(shares.values())
        fading = {link: s / least for link, s in shares.items() if s < least}
        if not fading:
            return full
        # a contact fades in and out: its constraint alone would let the torque jump where it begins and ends
        rest = self._command(state, target, {link: s for link, s in shares.items() if link not in fading})
        b = float(minimum_jerk(min(fading.values())))
        forces = {link: b * f + (1.0 - b) * rest.forces.get(link, 0.0 * f) for link, f in full.forces.items()}
        torque, acceleration = (b * x + (1.0 - b) * y for x, y in zip(full[:2], rest[:2], strict=True))
        return StanceCommand(torque, acceleration, MappingProxyType(forces), full.feasible and rest.feasible)

    def _command(self, state: GroundState, target: GroundTarget, given: Mapping[str, float]) -> StanceCommand:
        """Solve the problem of :meth:`command` for contacts with their shares."""
        M, bias, rows, shares = self._setting(state, given)
        n, joints = self.model.n, slice(BASE, None)
        J, drift = np.concatenate([each.J for each in rows]), np.concatenate([each.drift for each in rows])
        count = len(J)
        bias[:BASE] -= 0.0 if state.push is None else state.push  # what no actuator gives
        bias[joints] -= 0.0 if state.interaction is None else state.interaction
        # equality rows of x = (dν, f / weight): contacts that hold, and the base over the weight, which has no actuator
        weight = self.weight
        E = np.block([[J, np.zeros((count, count))], [M[:BASE] / weight, -J[:, :BASE].T]])
        x, N = solutions(E, -np.concatenate([drift, bias[:BASE] / weight]))
        T = np.hstack([M[joints], -weight * J[:, joints].T])  # τ = T x + bias of the joints
        apart = weight * SHARE * _sizes(rows)[:, None] * (np.eye(count) - share_map(J[:, :BASE].T, shares, rows))
        A = np.zeros((n + 1 + 2 + n + count, BASE + n + count))
        A[:n, BASE : BASE + n], A[n, 2] = np.eye(n), 1.0
        A[n + 1, 0] = A[n + 2, 1] = DRIFT
        A[n + 3 : 2 * n + 3] = EFFORT * T
        A[2 * n + 3 :, BASE + n :] = apart
        b = np.zeros(len(A))
        a = np.zeros_like(state.q) if target.a is None else target.a
        e = np.append(target.q - state.q, target.pitch - state.pitch)
        rate = np.append(target.v - state.v, target.pitch_rate - state.pitch_rate)
        b[: n + 1] = np.append(a, target.pitch_acceleration) + self.kp * e + self.kd * rate
        b[n + 3 : 2 * n + 3] = -EFFORT * bias[joints]
        # what springs and friction take is part of the limit
        added = self.model.springs(state.q)
        if self.friction is not None:
            added = added + self.friction.torque(self.model, State(state.q, state.v), Target(state.q, state.v))
        limit = np.minimum(self.limit, self.power / np.maximum(np.abs(state.v), 1e-9))
        least, most = -limit - added - bias[joints] - T @ x, limit - added - bias[joints] - T @ x
        F, low, top = self._forces(rows, shares / max(shares.sum(), 1e-9))
        low, top = low - F @ x, top - F @ x
        cones, caps = slice(None, -len(rows)), slice(-len(rows), None)
        # a seat that is left may have to bear more than its share: then shares yield, and no foot slips or tips
        groups = [Rows(T @ N, least, most), *(Rows(F[part] @ N, low[part], top[part]) for part in (cones, caps))]
        y, feasible = minimise(A @ N, b - A @ x, groups)
        x = x + N @ y
        torque = np.clip(T @ x + bias[joints] + added, -limit, limit)
        parts = np.split(weight * x[BASE + n :], np.cumsum([len(each.J) for each in rows[:-1]]))
        forces = dict(zip(given, parts, strict=True))
        return StanceCommand(torque, x[: BASE + n], MappingProxyType(forces), feasible)

    def band(self, state: GroundState, target: GroundTarget) -> FloatArray:
        """Compute the standard deviation of the torque by the estimate's covariance.

        Accelerations and shares are those of :meth:`command`; what the base needs is borne by the soles.

        Args:
            state: Measured state, with the contacts that hold.
            target: Reference at this moment.

        Returns:
            Standard deviation [N·m], (n,); zero of an exact model.

        Raises:
            ExoidError: Nothing touches the ground or has a share, or a number is missing.
        """
        if self.estimate is None:
            return np.zeros(self.model.n)
        a, model, pitch = self.command(state, target).acceleration, self.estimate.model, float(state.pitch)
        *_, rows, shares = self._setting(state, {link: float(state.shares.get(link, 1.0)) for link in state.contacts})
        J = np.concatenate([each.J for each in rows])
        turn = np.array([[np.cos(pitch), -np.sin(pitch)], [np.sin(pitch), np.cos(pitch)]])
        torso = TorsoMotion(np.array([pitch]), np.array([float(state.pitch_rate)]), a[2:3], (turn @ a[:2])[None])
        columns = model.regressor(state.q[None], state.v[None], a[None, BASE:], torso)[
            0
        ]  # of all parameters, (3 + n, P)
        T = columns[BASE:] - J[:, BASE:].T @ share_map(J[:, :BASE].T, shares, rows, bearing=True) @ columns[:BASE]
        return np.asarray(np.sqrt(np.einsum("ip,pq,iq->i", T, self.estimate.covariance, T).clip(0.0)))

    def in_c(self, dialect: Dialect) -> LawInC:
        """Describe the law in C: that of :meth:`command`, with a solver that the caller gives.

        Args:
            dialect: Double precision.

        Returns:
            Description of inputs and tables. Without any contact or solution the step is the safe torque.

        Raises:
            ExoidError: The precision is single, or a term has no form in C.
        """
        return stance_in_c(self.model, self.friction, self.rate, self.numbers, dialect)

    @property
    def numbers(self) -> dict[str, tuple[ArrayLike, str]]:
        """Numbers of the law by their names in C, each with its comment."""
        return {
            "kp": (self.kp, "gains of angles, of the pitch last [1/s^2]"),
            "kd": (self.kd, "gains of rates [1/s]"),
            "most": (self.limit, "largest torque [N m]"),
            "power": (self.power, "largest power [W]"),
            "ground_friction": (self.ground_friction, "coefficient of friction that the law may use"),
            "margin": (self.margin, "distance of the centre of pressure from the ends of a sole [m]"),
            "weight": (self.weight, "weight of the machine, by which forces are scaled [N]"),
            "effort": (EFFORT, "square root of the cost of torque [1/(N m)]"),
            "share_cost": (SHARE, "of forces beside their shares [1/N]"),
            "drift_cost": (DRIFT, "of the hip [s^2/m]"),
            "arm": (ARM, "by which forces and moments are compared [m]"),
            "fading": (FADING, "share over the largest below which a contact fades"),
            "yields": (YIELDS, "slack of a row that yields at the cost 1, over its size"),
            "least_share": (LEAST_SHARE, "least normal force beside others, over the weight and its share"),
            "largest_share": (LARGEST_SHARE, "largest force of a contact that bears all, over the weight"),
        }

    def _setting(
        self, state: GroundState, shares: Mapping[str, float]
    ) -> tuple[FloatArray, FloatArray, list[ContactRows], FloatArray]:
        """Inertia and bias forces in a state, and rows of some of its contacts with their shares."""
        pose = state.q, state.v, float(state.pitch), float(state.pitch_rate)
        M, bias = self.model.dynamics(*pose)
        cone = self.ground_friction, self.margin, state.lean
        rows = [self.model.contact(link, state.contacts[link], pose, cone) for link in shares]
        return M, bias, rows, np.array(list(shares.values()))

    def _forces(self, rows: list[ContactRows], shares: FloatArray) -> Rows:
        """Bounds of forces over the weight: cones of all contacts, then the normal force of each by its share."""
        start = BASE + self.model.n
        F = np.zeros((sum(len(each.cone) for each in rows) + len(rows), start + sum(len(each.J) for each in rows)))
        low, top, row = np.full(len(F), -np.inf), np.zeros(len(F)), 0
        low[-len(rows) :], top[-len(rows) :] = LEAST_SHARE * shares * (len(rows) > 1), LARGEST_SHARE * shares
        for k, each in enumerate(rows):
            F[row : row + len(each.cone), start : start + len(each.J)] = each.cone
            F[k - len(rows), start + 1] = 1.0
            row, start = row + len(each.cone), start + len(each.J)
        return Rows(F, low, top)

    @cached_property
    def weight(self) -> float:
        """Weight of the machine [N], by which forces are scaled."""
        # not by dynamics(), whose pose contact() uses
        return max(1.0, float(sum(body.mass for body in self.model.pinocchio.inertias)) * GRAVITY)


def stance(
    source: Estimate | Leg | GroundPlant,
    soles: Mapping[str, Sole] | None = None,
    *,
    kp: ArrayLike = 100.0,
    kd: ArrayLike = 20.0,
    friction: FrictionCompensation | None = PASSIVE,
    ground_friction: float = 0.6,
    limit: ArrayLike | None = None,
    power: ArrayLike = np.inf,
    rate: float = 1000.0,
) -> StanceLaw:
    """Make a whole-body law for a machine that stands, sits or steps: joint and torso motion by inverse dynamics.

    The forces of the ground are unknown, and stay within the friction cone and the soles. With ``kp = kd = 0`` and a
    reference without acceleration the law carries the weight and does not track; low gains are an impedance about the
    reference of stiffness kp M.

    Args:
        source: Estimate of a machine on a floating base; a machine, which has no friction; or a plant for an exact
            model.
        soles: Places that can touch the ground or a chair by the name of their link; None for the built-in machines.
        kp: Gain of angles [1/s²]: a number, one for each joint, or one for each joint and the pitch.
        kd: Gain of rates [1/s], likewise.
        friction: Compensation of joint friction, which never drives; None for none.
        ground_friction: Coefficient of friction that the law may use, less than that of the ground.
        limit: Largest torque [N·m], a number or (n,); None for the limits of the URDF. Zero at passive joints.
        power: Largest power of a joint [W], a number or (n,).
        rate: Rate of the law in C [Hz], for its watchdog.

    Returns:
        The law.

    Raises:
        ExoidError: The base does not float, the estimate does not know the total mass, the machine is not planar, DAQP
            is not installed, or a number is out of range.

    Example:
        >>> machine = exoid.load_exo("bleex", base="floating")
        >>> law = exoid.control.stance(machine)
        >>> q = np.array([0.3, -0.6, 0.3] * 2)
        >>> both = {"left_foot": "flat", "right_foot": "flat"}
        >>> state = GroundState(q, np.zeros(6), 0.0, 0.0, both)
        >>> command = law.command(state, GroundTarget(q, np.zeros(6)))
        >>> round(sum(float(force[1]) for force in command.forces.values()) / 9.81, 1)  # kg
        49.0
    """
    require_daqp()
    model = GroundModel.on(source, soles)
    n = model.n
    checked(ground_friction, "the friction that the law may use", above=0.0)
    limit = model.leg.limits.effort if limit is None else limit
    estimate = source if isinstance(source, Estimate) else None
    return StanceLaw(
        model,
        _per_task(kp, "kp", n),
        _per_task(kd, "kd", n),
        friction,
        float(ground_friction),
        model.driven(np.broadcast_to(checked(limit, "limit", least=0.0, infinite=True), n)),
        np.broadcast_to(checked(power, "power", above=0.0, infinite=True), n),
        # distance of the centre of pressure from the ends of a sole [m], with two standard deviations of its place
        0.01 + (0.0 if estimate is None else 2.0 * _pressure_std(estimate)),
        estimate,
        float(checked(rate, "rate", above=0.0)),
    )


def share_map(A: FloatArray, shares: FloatArray, rows: list[ContactRows], *, bearing: bool = False) -> FloatArray:
    """Map forces f to f_share = G A f, which bears the same load by the shares; ``bearing``: load to forces, G."""
    sizes = np.concatenate([np.full(len(each.J), s) for each, s in zip(rows, shares, strict=True)])
    sizes = sizes / _sizes(rows) ** 2
    ASA = (A * sizes) @ A.T
    # two points cannot bear any load of three rows when all of it is on one of them: then the least squares
    ASA[np.diag_indices(BASE)] += 1e-9 * max(float(np.trace(ASA)), 1e-9)
    G = sizes[:, None] * np.linalg.solve(ASA, A).T
    return G if bearing else G @ A


def _sizes(rows: list[ContactRows]) -> FloatArray:
    """Sizes by which forces and moments are compared, 1 for a force and 1 / ARM for a moment."""
    return np.concatenate([(1.0, 1.0, 1.0 / ARM)[: len(each.J)] for each in rows])


def _pressure_std(estimate: Estimate) -> float:
    """Standard deviation of the place of the weight's line, forward of the hip, upright with bent knees [m]."""
    bent = np.zeros(len(estimate.joint_names))
    for limb in estimate.leg.limbs:
        knee = limb.joints.start + 1
        lower, upper = estimate.leg.limits.lower[knee], estimate.leg.limits.upper[knee]
        bent[knee] = 0.5 * np.sign(lower + upper) if np.isfinite(lower + upper) else 0.0
    rows = estimate.leg.regressor(bent[None], 0.0 * bent[None], 0.0 * bent[None])[0]
    p = len(estimate.leg.parameter_names)
    _, up, moment = rows @ estimate.values[:p] @ np.eye(BASE, len(rows)).T
    slope = (rows[2] - moment / up * rows[1]) / up
    return float(np.sqrt(max(slope @ estimate.covariance[:p, :p] @ slope, 0.0)))


def _per_task(gain: ArrayLike, name: str, n: int) -> FloatArray:
    """Gains of joints and pitch, (n + 1,); that of the pitch is the mean of the joints' if it is not given."""
    values = np.atleast_1d(checked(gain, name, least=0.0))
    if values.shape == (n,):
        return np.append(values, values.mean())
    if values.shape not in ((1,), (n + 1,)):
        raise BadArgumentError(f"{name} has the shape {values.shape} for {n} joints", remedy="give 1, n or n + 1 gains")
    return np.broadcast_to(values, n + 1)


def _refuse(model: GroundModel, state: GroundState, target: GroundTarget) -> None:
    """Refuse a state that no law on the ground can support, and numbers that are missing."""
    if not any(state.shares.get(link, 1.0) for link in state.contacts):
        raise BadArgumentError(
            "no support in the air: nothing touches the ground, or has a share of the load",
            where=model.leg.description.name,
            remedy="brake the joints until a foot touches, or hold the torso and use exoid.control.impedance",
        )
    unknown = [link for link in (*state.contacts, *state.shares) if link not in model.soles]
    kinds = [kind for kind in state.contacts.values() if kind not in ("flat", "heel", "toe")]
    if unknown or kinds:
        what = f"contacts {dict(state.contacts)} with shares {dict(state.shares)}"
        raise BadArgumentError(what, remedy=f"name {', '.join(model.soles)} with flat, heel or toe")
    own = [x for x in (state.q, state.v, state.interaction, target.q, target.v, target.a) if x is not None]
    push = np.zeros(BASE) if state.push is None else state.push
    shapes = np.shape(push) == (BASE,) and all(np.shape(x) == (model.n,) for x in own)
    if not shapes or not np.isfinite([*np.concatenate([push, *own]), *state[2:4], state.lean, *target[3:]]).all():
        raise BadArgumentError(
            f"{state} with {target}", remedy=f"give finite numbers: {model.n} for the joints, {BASE} for a push"
        )
    checked([float(s) for s in state.shares.values()] or 0.0, "shares of the load", least=0.0)
    angles = np.abs([*state.q, *target.q, state.pitch, target.pitch])
    checked(angles.max(), "the largest angle of state and target [rad], not degrees", most=2.0 * np.pi)
