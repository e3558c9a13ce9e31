"""One step of a single rig on Pinocchio's dynamics, for any leg: the reference for the planar rigs."""

from __future__ import annotations

from operator import mul
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.model import configuration

from .plant import Plant
from .stepper import Step, spring_energy
from .stick_slip import CORRECTIONS, TURNS, Friction, descend

Matrix = list[list[float]]

INFINITE = float("inf")


class _Joint(NamedTuple):
    """A joint of the plant in plain floats, see :class:`exoid.rig.Plant`."""

    b2: float
    b1: float
    b0: float
    viscous: float
    armature: float
    kinetic: float
    static: float
    lower: float
    upper: float


class PinocchioStepper:
    """A single rig, of a planar leg or not; the same scheme as :class:`exoid.rig.PlanarStepper`.

    Arrays of three numbers cost more in NumPy than their arithmetic does, so that only Pinocchio sees arrays and the
    rest is done in plain floats. While all joints slide on, friction is a known torque and the articulated-body
    algorithm does the step; only a joint that rests, or is about to, needs the stick-slip problem solved.
    """

    def __init__(self, plant: Plant, q: FloatArray, v: FloatArray, dt: float) -> None:
        if plant.count != 1:
            raise ExoidError(f"Pinocchio steps one rig, not {plant.count}", remedy="use plant.take([k])")
        leg = plant.leg.with_parameters(plant.parameters[:, 0])
        self.plant, self.dt = plant, dt
        self._q: list[float] = np.asarray(q, dtype=np.float64)[:, 0].tolist()
        self._v: list[float] = np.asarray(v, dtype=np.float64)[:, 0].tolist()
        self._ahead = self._v  # velocities expected in the middle of the next step
        self._model = pin.Model(leg.model)
        self._model.gravity.linear = leg.gravity_of_tilted_torso(float(plant.pitch[0]))
        self._data = self._model.createData()
        self._turns = self._model.nq != self._model.nv
        self._at, self._rate, self._force = np.zeros((3, plant.n))
        self._inertia = self._model.armature  # a view: what is written here, Pinocchio adds to its mass matrix
        self._joints = _joints(plant)
        self._kinetic = [dt * joint.kinetic for joint in self._joints]

    @property
    def q(self) -> FloatArray:
        """Angles [rad], (n, 1)."""
        return np.array([self._q]).T

    @property
    def v(self) -> FloatArray:
        """Velocities [rad/s], (n, 1)."""
        return np.array([self._v]).T

    def step(self, torque: FloatArray, damping: FloatArray) -> Step:
        """See :class:`exoid.rig.Stepper`."""
        before = self._v
        taken = self.advance(torque[:, 0].tolist(), damping[:, 0].tolist())
        mean = [0.5 * (x + y) for x, y in zip(before, self._v, strict=True)]
        return Step(np.array([mean]).T, np.array([taken]).T)

    def advance(self, torque: list[float], damping: list[float]) -> list[float]:
        """Take one step in plain floats; return the impulses that friction and stops took."""
        dt, half, last, old = self.dt, 0.5 * self.dt, self._v, self._q
        at, rate, inertia, effort = self._at, self._rate, self._inertia, self._force
        force, taken, slides = [], [], True
        for i, (b2, b1, b0, viscous, armature, kinetic, _, low, high) in enumerate(self._joints):
            y = last[i]
            x = old[i] + half * y
            resistance = viscous + damping[i]
            inertia[i] = armature + half * resistance
            at[i], rate[i] = x, self._ahead[i]
            net = torque[i] - resistance * y - (b2 * x + b1) * x - b0
            rub = kinetic if y > 0.0 else -kinetic
            effort[i] = net - rub
            force.append(net)
            taken.append(dt * rub)
            if y == 0.0 or x <= low or x >= high:
                slides = False
        new = self._slide() if slides else None
        if new is None:
            new, taken = self._stick_or_slip(force)
        q, ahead = [], []
        for x, y, z in zip(old, last, new, strict=True):
            mean = 0.5 * (y + z)
            q.append(x + dt * mean)
            ahead.append(2.0 * z - mean)
        self._q, self._v, self._ahead = q, new, ahead
        return taken

    def energy(self) -> FloatArray:
        """See :class:`exoid.rig.Stepper`."""
        self._inertia[:] = 0.0  # whether Pinocchio counts rotors among the kinetic energy depends on its version
        q, v = configuration(self._model, self.q.T)[0], self.v[:, 0]
        moving = pin.computeKineticEnergy(self._model, self._data, q, v)
        raised = pin.computePotentialEnergy(self._model, self._data, q)
        rotors = 0.5 * float(self.plant.armature[:, 0] @ v**2)
        return np.asarray(moving + raised + rotors + spring_energy(self.plant, self.q))

    def _slide(self) -> list[float] | None:
        """Velocities after the step if every joint goes on sliding as it does; None if one does not."""
        dt, new = self.dt, []
        a = pin.aba(self._model, self._data, self._configuration(), self._rate, self._force).tolist()
        for x, y in zip(self._v, a, strict=True):
            z = x + dt * y
            if not x * z > 0.0:
                return None
            new.append(z)
        return new

    def _stick_or_slip(self, force: list[float]) -> tuple[list[float], list[float]]:
        """Velocities after the step, and impulses taken, whatever the joints do."""
        dt, at, last = self.dt, self._configuration(), self._v
        bias = pin.nonLinearEffects(self._model, self._data, at, self._rate).tolist()
        upper = pin.crba(self._model, self._data, at).tolist()
        for i, row in enumerate(upper):
            for j in range(i):
                row[j] = upper[j][i]
        b = [sum(map(mul, row, last)) + dt * (f - h) for row, f, h in zip(upper, force, bias, strict=True)]
        joints = list(zip(self._at.tolist(), self._joints, strict=True))
        low = [-INFINITE if x <= joint.lower else -dt * joint.static for x, joint in joints]
        high = [INFINITE if x >= joint.upper else dt * joint.static for x, joint in joints]
        new = solve_scalar(upper, b, self._kinetic, low, high, last)
        for _ in range(TURNS):
            if all(x * y >= 0.0 for x, y in zip(last, new, strict=True)):
                break
            before = [
                x - 2.0 * y / (abs(y) + abs(z)) * c if y * z < 0.0 else x
                for x, y, z, c in zip(b, last, new, self._kinetic, strict=True)
            ]
            new = solve_scalar(upper, before, self._kinetic, low, high, new)
        return new, [x - sum(map(mul, row, new)) for x, row in zip(b, upper, strict=True)]

    def _configuration(self) -> FloatArray:
        return configuration(self._model, self._at[None])[0] if self._turns else self._at


def _joints(plant: Plant) -> list[_Joint]:
    rows = (*plant.stiffness, plant.viscous, plant.armature, plant.coulomb, plant.static, plant.lower, plant.upper)
    return [_Joint(*values) for values in np.array(rows)[..., 0].T.tolist()]


def solve_scalar(
    M: Matrix, b: list[float], kinetic: list[float], low: list[float], high: list[float], last: list[float]
) -> list[float]:
    """Solve the stick-slip problem of :mod:`exoid.rig.stick_slip` for one rig, in plain floats.

    Args:
        M: Mass matrix, n lists of n.
        b: Momenta.
        kinetic: Impulse that a moving joint takes.
        low: Least impulse that a resting joint takes.
        high: Largest.
        last: Velocities before.

    Returns:
        Velocities, zero where a joint rests.
    """
    pattern = [
        0 if (x > 0.0 and most == INFINITE) or (x < 0.0 and least == -INFINITE) else (x > 0.0) - (x < 0.0)
        for x, least, most in zip(last, low, high, strict=True)
    ]
    for _ in range(CORRECTIONS + 1):
        v = _eliminate(M, [x - c * p for x, c, p in zip(b, kinetic, pattern, strict=True)], pattern)
        right = True
        for i, p in enumerate(pattern):
            if p:
                wanted = p if v[i] * p > 0.0 else 0
            else:
                taken = b[i] - sum(map(mul, M[i], v))
                wanted = (taken > high[i]) - (taken < low[i])
            if wanted != p:
                pattern[i], right = wanted, False
        if right:
            return v
    columns = [np.array(x)[:, None] for x in (b, kinetic, low, high)]
    return list(
        descend(np.array(M)[..., None], columns[0], Friction(columns[1], columns[2], columns[3]))[:, 0].tolist()
    )


def _eliminate(M: Matrix, v: list[float], pattern: list[int]) -> list[float]:
    """Solve M v = v, in place, for the joints that move, by elimination without pivots; the others get zero."""
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
