"""Ledger of a run: forces and velocities of all steps, for its audit."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray

from .audit import Audit
from .engine import Engine


class Ledger:
    """Forces and velocities of the steps of a log so far."""

    def __init__(self, engine: Engine, steps: int) -> None:
        size = len(engine.rate)
        self._engine, self._steps = engine, steps
        self._rate, self._ground, self._held = np.zeros((3, steps + 1, size))
        self._torque = np.zeros((steps + 1, len(engine.v)))
        self._energy: list[float] = []
        self._momentum: list[FloatArray] = []

    def begin(self, step: int) -> None:
        """Note the state that a step begins with."""
        self._rate[step] = self._engine.rate
        if step in (0, self._steps):
            self._energy.append(self._engine.energy)
            self._momentum.append(self._engine.momentum)

    def finish(self, step: int, torque: FloatArray, spring: FloatArray | None) -> None:
        """Note the forces of a step."""
        rail = self._engine.rail
        self._ground[step] = self._engine.constraint - rail
        self._held[step] = rail if spring is None else spring
        self._torque[step] = torque

    def audit(self, dt: float) -> Audit:
        """Sum up."""
        plant, base = self._engine.plant, self._engine.base
        mean = 0.5 * (self._rate[1:] + self._rate[:-1])
        joints, start = mean[:, base:], self._rate[:-1, base:]
        power = self._torque[:-1] * joints
        ground, held = self._ground[:-1], self._held[:-1]
        return Audit(
            work=float(dt * power.sum()),
            holding=float(dt * np.vdot(held, mean)),
            gain=self._energy[1] - self._energy[0],
            friction=float(dt * np.vdot(plant.friction(start), joints)),
            contact=-float(dt * np.vdot(ground, mean)),
            turnover=float(dt * np.abs(power).sum()),
            ground=self._impulse(ground, dt),
            holder=self._impulse(held, dt),
            weight=-dt * len(mean) * self._engine.weight * plant.plane.up,
            momentum=self._momentum[1] - self._momentum[0],
        )

    def _impulse(self, forces: FloatArray, dt: float) -> FloatArray:
        """Sum up the linear part of generalised forces."""
        total, plane = dt * forces.sum(axis=0), self._engine.plant.plane
        planar = self._engine.plant.is_planar
        return np.asarray(total[0] * plane.forward + total[1] * plane.up if planar else total[:3])
