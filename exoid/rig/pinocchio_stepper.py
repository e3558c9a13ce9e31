"""One step of a single rig on Pinocchio's dynamics, for any leg: the reference for the planar rigs."""

from __future__ import annotations

from operator import mul

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.model import configuration

from .plant import Plant
from .stepper import Step, spring_energy
from .stick_slip import Friction, descend

Matrix = list[list[float]]

CORRECTIONS = 30
"""Patterns tried before falling back on coordinate descent."""


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
        self._change = [0.0] * plant.n
        self._model = pin.Model(leg.model)
        self._model.gravity.linear = leg.gravity_of_tilted_torso(float(plant.pitch[0]))
        self._data = self._model.createData()
        self._turns = self._model.nq != self._model.nv
        self._at, self._rate, self._force = np.zeros((3, plant.n))
        self._inertia = self._model.armature  # a view: what is written here, Pinocchio adds to its mass matrix
        self._coulomb, self._static = plant.coulomb[:, 0].tolist(), plant.static[:, 0].tolist()
        self._lower, self._upper = plant.lower[:, 0].tolist(), plant.upper[:, 0].tolist()
        self._springs = plant.stiffness[..., 0].T.tolist()
        self._viscous, self._armature = plant.viscous[:, 0].tolist(), plant.armature[:, 0].tolist()

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
        dt, joints, last = self.dt, range(len(self._q)), self._v
        half = 0.5 * dt
        q = [x + half * y for x, y in zip(self._q, last, strict=True)]
        force = []
        for i in joints:
            b2, b1, b0 = self._springs[i]
            x, y, resistance = q[i], last[i], self._viscous[i] + damping[i]
            self._at[i], self._rate[i] = x, y + 0.5 * self._change[i]
            force.append(torque[i] - resistance * y - (b2 * x + b1) * x - b0)
            self._inertia[i] = self._armature[i] + half * resistance
        new = self._slide(force, q)
        taken = [dt * c * ((x > 0.0) - (x < 0.0)) for c, x in zip(self._coulomb, last, strict=True)]
        if new is None:
            new, taken = self._stick_or_slip(force, q)
        self._change = [x - y for x, y in zip(new, last, strict=True)]
        self._q = [x + half * (y + z) for x, y, z in zip(self._q, last, new, strict=True)]
        self._v = new
        return taken

    def energy(self) -> FloatArray:
        """See :class:`exoid.rig.Stepper`."""
        self._inertia[:] = self._armature
        q, v = configuration(self._model, self.q.T)[0], self.v[:, 0]
        moving = pin.computeKineticEnergy(self._model, self._data, q, v)
        raised = pin.computePotentialEnergy(self._model, self._data, q)
        rotors = 0.5 * float(self.plant.armature[:, 0] @ v**2)
        return np.asarray(moving + raised + rotors + spring_energy(self.plant, self.q))

    def _slide(self, force: list[float], q: list[float]) -> list[float] | None:
        """Velocities after the step if every joint goes on sliding as it does, free of its stops; else None."""
        for i, x in enumerate(self._v):
            if x == 0.0 or q[i] <= self._lower[i] or q[i] >= self._upper[i]:
                return None
            self._force[i] = force[i] - (self._coulomb[i] if x > 0.0 else -self._coulomb[i])
        a = pin.aba(self._model, self._data, self._configuration(), self._rate, self._force).tolist()
        new = [x + self.dt * y for x, y in zip(self._v, a, strict=True)]
        return new if all(x * y > 0.0 for x, y in zip(self._v, new, strict=True)) else None

    def _stick_or_slip(self, force: list[float], q: list[float]) -> tuple[list[float], list[float]]:
        """Velocities after the step, and impulses taken, whatever the joints do."""
        dt, n, at = self.dt, len(q), self._configuration()
        bias = pin.nonLinearEffects(self._model, self._data, at, self._rate).tolist()
        upper = pin.crba(self._model, self._data, at).tolist()
        M = [[upper[i][j] if i <= j else upper[j][i] for j in range(n)] for i in range(n)]
        b = [sum(map(mul, row, self._v)) + dt * (f - h) for row, f, h in zip(M, force, bias, strict=True)]
        kinetic = [dt * c for c in self._coulomb]
        low = [-np.inf if x <= stop else -dt * c for x, stop, c in zip(q, self._lower, self._static, strict=True)]
        high = [np.inf if x >= stop else dt * c for x, stop, c in zip(q, self._upper, self._static, strict=True)]
        new = solve_scalar(M, b, kinetic, low, high, self._v)
        return new, [x - sum(map(mul, row, new)) for x, row in zip(b, M, strict=True)]

    def _configuration(self) -> FloatArray:
        return configuration(self._model, self._at[None])[0] if self._turns else self._at


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
    n = len(b)
    pattern = [(x > 0.0) - (x < 0.0) for x in last]
    for _ in range(CORRECTIONS):
        pattern = [
            0 if (p > 0 and h == np.inf) or (p < 0 and x == -np.inf) else p
            for p, x, h in zip(pattern, low, high, strict=True)
        ]
        moving = [i for i in range(n) if pattern[i]]
        v = [0.0] * n
        for i, x in zip(moving, _eliminate(M, [b[i] - kinetic[i] * pattern[i] for i in moving], moving), strict=True):
            v[i] = x
        called_for = []
        for i, p in enumerate(pattern):
            if p:
                called_for.append(p if v[i] * p > 0.0 else 0)
            else:
                taken = b[i] - sum(map(mul, M[i], v))
                called_for.append((taken > high[i]) - (taken < low[i]))
        if called_for == pattern:
            return v
        pattern = called_for
    columns = (np.array(x)[:, None] for x in (kinetic, low, high))
    return list(descend(np.array(M)[..., None], np.array(b)[:, None], Friction(*columns))[:, 0])


def _eliminate(M: Matrix, rhs: list[float], rows: list[int]) -> list[float]:
    """Solve for the moving joints by elimination without pivots."""
    A = [[M[i][j] for j in rows] for i in rows]
    n = len(rows)
    for k in range(n - 1):
        pivot = A[k]
        for i in range(k + 1, n):
            row = A[i]
            factor = row[k] / pivot[k]
            for j in range(k + 1, n):
                row[j] -= factor * pivot[j]
            rhs[i] -= factor * rhs[k]
    for k in range(n - 1, -1, -1):
        row = A[k]
        for j in range(k + 1, n):
            rhs[k] -= row[j] * rhs[j]
        rhs[k] /= row[k]
    return rhs
