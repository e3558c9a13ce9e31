"""Integration step of a single rig with Pinocchio's dynamics, for any leg: the reference for planar rigs."""

from __future__ import annotations

from operator import mul
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.model import configuration

from .plant import Plant
from .stepper import Equations, Step, Stepper, spring_energy
from .stick_slip import CORRECTIONS, REVERSALS, Friction, descend

Matrix = list[list[float]]

INFINITE = float("inf")


class _Joint(NamedTuple):
    """Joint of the plant in plain floats, see :class:`exoid.rig.Plant`."""

    b2: float
    b1: float
    b0: float
    viscous: float
    armature: float
    coulomb: float
    static: float
    lower: float
    upper: float


class PinocchioBodies:
    """Rigid bodies of one rig of any leg by Pinocchio's algorithms."""

    def __init__(self, plant: Plant) -> None:
        if plant.count != 1:
            raise BadArgumentError(
                f"Pinocchio steps one rig, not the {plant.count} rigs given", remedy="use plant.take([k])"
            )
        leg = plant.leg.with_parameters(plant.parameters[:, 0])
        self.model = pin.Model(leg.model)
        self.model.gravity.linear = leg.gravity_of_tilted_torso(float(plant.pitch[0]))
        self.data = self.model.createData()

    def dynamics(self, q: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Mass matrix, (n, n, 1), and bias torque, (n, 1)."""
        at = configuration(self.model, q.T)[0]
        upper = np.triu(pin.crba(self.model, self.data, at))
        bias = pin.nonLinearEffects(self.model, self.data, at, v[:, 0])
        return (upper + np.triu(upper, 1).T)[..., None], np.array(bias)[:, None]

    def energy(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """Kinetic and potential energy, (1,)."""
        at = configuration(self.model, q.T)[0]
        self.model.armature[:] = 0.0  # only some versions of Pinocchio include rotors in the kinetic energy
        moving = pin.computeKineticEnergy(self.model, self.data, at, v[:, 0])
        return np.array([moving + pin.computePotentialEnergy(self.model, self.data, at)])


class PinocchioStepper(Stepper):
    """Single rig of any leg, with the scheme of :class:`exoid.rig.PlanarStepper`.

    NumPy's overhead on arrays of three numbers exceeds their arithmetic, so that only Pinocchio receives arrays and all
    else is done in plain floats. While all joints keep sliding, friction is a known torque and the articulated-body
    algorithm computes the step. The stick-slip problem is solved only if a joint rests or may come to rest.

    Args:
        plant: One rig.
        q: Initial angles [rad], (n, 1).
        v: Initial velocities [rad/s], (n, 1).
        dt: Step [s].

    Raises:
        ExoidError: The plant has more than one rig.
    """

    def __init__(self, plant: Plant, q: FloatArray, v: FloatArray, dt: float) -> None:
        self.plant, self.dt = plant, dt
        self._q: list[float] = np.asarray(q, dtype=np.float64)[:, 0].tolist()
        self._v: list[float] = np.asarray(v, dtype=np.float64)[:, 0].tolist()
        self._ahead = self._v  # velocities expected in the middle of the next step
        self._bodies = PinocchioBodies(plant)
        self._model, self._data = self._bodies.model, self._bodies.data
        self._turns = self._model.nq != self._model.nv
        self._at, self._rate, self._force = np.zeros((3, plant.n))
        self._inertia = self._model.armature  # a view of the armature that Pinocchio adds to its mass matrix
        joints = (*plant.stiffness, *(getattr(plant, name) for name in _Joint._fields[3:]))
        self._joints = [_Joint(*values) for values in np.array(joints)[..., 0].T.tolist()]
        self._kinetic = [dt * joint.coulomb for joint in self._joints]

    @property
    def q(self) -> FloatArray:  # type: ignore[override]  # the state is in plain floats
        """Angles [rad], (n, 1)."""
        return np.array([self._q]).T

    @property
    def v(self) -> FloatArray:  # type: ignore[override]
        """Velocities [rad/s], (n, 1)."""
        return np.array([self._v]).T

    def step(self, torque: FloatArray, damping: FloatArray) -> Step:
        """Advance by dt in plain floats."""
        before = self._v
        impulse = self.advance(torque[:, 0].tolist(), damping[:, 0].tolist())
        mean = [0.5 * (x + y) for x, y in zip(before, self._v, strict=True)]
        return Step(np.array([mean]).T, np.array([impulse]).T)

    def advance(self, torque: list[float], damping: list[float]) -> list[float]:
        """Advance by dt in plain floats, faster than :meth:`step`.

        Args:
            torque: Torque τ₀ of each joint [N·m].
            damping: Damping of each actuator [N·m·s/rad].

        Returns:
            Impulse of friction and end stops at each joint [N·m·s].
        """
        force = self._set_middle(torque, damping)
        sliding = self._slide(force)
        new, impulse = self._stick_or_slip(*self._mass_and_impulse(force)) if sliding is None else sliding
        self._move(new)
        return impulse

    def equations(self, torque: FloatArray, damping: FloatArray) -> Equations:
        """Compute the equations of the next step."""
        M, impulse = self._mass_and_impulse(self._set_middle(torque[:, 0].tolist(), damping[:, 0].tolist()))
        return Equations(np.array(M)[..., None], np.array([impulse]).T)

    def solve(self, equations: Equations) -> Step:
        """Advance by dt with stick-slip friction and end stops."""
        new, impulse = self._stick_or_slip(equations.M[..., 0].tolist(), equations.impulse[:, 0].tolist())
        return Step(np.array([self._move(new)]).T, np.array([impulse]).T)

    def move(self, v: FloatArray) -> FloatArray:
        """Advance by dt to known velocities."""
        return np.array([self._move(v[:, 0].tolist())]).T

    def energy(self) -> FloatArray:
        """Compute the mechanical energy, springs and rotors included."""
        rotors = 0.5 * float(self.plant.armature[:, 0] @ self.v[:, 0] ** 2)
        return np.asarray(self._bodies.energy(self.q, self.v) + rotors + spring_energy(self.plant, self.q))

    def _set_middle(self, torque: list[float], damping: list[float]) -> list[float]:
        """Set angles, rates and inertias of the middle of the step; return the torques without bodies and friction."""
        half, force = 0.5 * self.dt, []
        at, rate, inertia = self._at, self._rate, self._inertia
        for i, (b2, b1, b0, viscous, armature, *_) in enumerate(self._joints):
            y = self._v[i]
            x = self._q[i] + half * y
            resistance = viscous + damping[i]
            inertia[i] = armature + half * resistance
            at[i], rate[i] = x, self._ahead[i]
            force.append(torque[i] - resistance * y - (b2 * x + b1) * x - b0)
        return force

    def _slide(self, force: list[float]) -> tuple[list[float], list[float]] | None:
        """Velocities after the step and impulses of friction if all joints keep sliding; None otherwise."""
        dt, new, impulse = self.dt, [], []
        for i, (x, y, joint) in enumerate(zip(self._at.tolist(), self._v, self._joints, strict=True)):
            if y == 0.0 or x <= joint.lower or x >= joint.upper:
                return None
            friction = joint.coulomb if y > 0.0 else -joint.coulomb
            self._force[i] = force[i] - friction
            impulse.append(dt * friction)
        a = pin.aba(self._model, self._data, self._configuration(), self._rate, self._force).tolist()
        for y, change in zip(self._v, a, strict=True):
            z = y + dt * change
            if not y * z > 0.0:
                return None
            new.append(z)
        return new, impulse

    def _move(self, new: list[float]) -> list[float]:
        """Take over the velocities after the step; return the mean velocities."""
        q, means, ahead = [], [], []
        for x, y, z in zip(self._q, self._v, new, strict=True):
            mean = 0.5 * (y + z)
            means.append(mean)
            q.append(x + self.dt * mean)
            ahead.append(2.0 * z - mean)
        self._q, self._v, self._ahead = q, new, ahead
        return means

    def _mass_and_impulse(self, force: list[float]) -> tuple[Matrix, list[float]]:
        """Mass matrix and impulse without friction, at the middle of the step."""
        at = self._configuration()
        bias = pin.nonLinearEffects(self._model, self._data, at, self._rate).tolist()
        upper = pin.crba(self._model, self._data, at).tolist()
        for i, row in enumerate(upper):
            for j in range(i):
                row[j] = upper[j][i]
        return upper, [self.dt * (f - h) for f, h in zip(force, bias, strict=True)]

    def _stick_or_slip(self, M: Matrix, impulse: list[float]) -> tuple[list[float], list[float]]:
        """Velocities after the step, and impulses of friction and end stops, in all other cases."""
        dt, last = self.dt, self._v
        b = [sum(map(mul, row, last)) + p for row, p in zip(M, impulse, strict=True)]
        joints = list(zip(self._at.tolist(), self._joints, strict=True))
        low = [-INFINITE if x <= joint.lower else -dt * joint.static for x, joint in joints]
        high = [INFINITE if x >= joint.upper else dt * joint.static for x, joint in joints]
        new = solve_scalar(M, b, self._kinetic, low, high, last)
        for _ in range(REVERSALS):
            if all(x * y >= 0.0 for x, y in zip(last, new, strict=True)):
                break
            before = [
                x - 2.0 * y / (abs(y) + abs(z)) * c if y * z < 0.0 else x
                for x, y, z, c in zip(b, last, new, self._kinetic, strict=True)
            ]
            new = solve_scalar(M, before, self._kinetic, low, high, new)
        return new, [x - sum(map(mul, row, new)) for x, row in zip(b, M, strict=True)]

    def _configuration(self) -> FloatArray:
        return configuration(self._model, self._at[None])[0] if self._turns else self._at


def solve_scalar(
    M: Matrix, b: list[float], kinetic: list[float], low: list[float], high: list[float], last: list[float]
) -> list[float]:
    """Solve the stick-slip problem of :mod:`exoid.rig.stick_slip` for one rig, in plain floats."""
    pattern = [
        0 if (x > 0.0 and most == INFINITE) or (x < 0.0 and least == -INFINITE) else (x > 0.0) - (x < 0.0)
        for x, least, most in zip(last, low, high, strict=True)
    ]
    for _ in range(CORRECTIONS + 1):
        v = _eliminate(M, [x - c * p for x, c, p in zip(b, kinetic, pattern, strict=True)], pattern)
        right = True
        for i, p in enumerate(pattern):
            if p:
                corrected = p if v[i] * p > 0.0 else 0
            else:
                impulse = b[i] - sum(map(mul, M[i], v))
                corrected = (impulse > high[i]) - (impulse < low[i])
            if corrected != p:
                pattern[i], right = corrected, False
        if right:
            return v
    columns = [np.array(x)[:, None] for x in (b, kinetic, low, high)]
    return list(
        descend(np.array(M)[..., None], columns[0], Friction(columns[1], columns[2], columns[3]))[:, 0].tolist()
    )


def _eliminate(M: Matrix, v: list[float], pattern: list[int]) -> list[float]:
    """Solve M x = v in place for the moving joints, by elimination without pivoting; resting joints get zero."""
    n = len(v)
    U = [row[:] for row in M]
    for k, row in enumerate(U):
        if not pattern[k]:
            v[k] = 0.0
            continue
        for i in range(k + 1, n):
            if pattern[i]:
                below, factor = U[i], row[i] / row[k]
                for j in range(i, n):
                    below[j] -= factor * row[j]
                v[i] -= factor * v[k]
    for i in range(n - 1, -1, -1):
        if pattern[i]:
            row = U[i]
            for k in range(i + 1, n):
                v[i] -= row[k] * v[k]
            v[i] /= row[i]
    return v
