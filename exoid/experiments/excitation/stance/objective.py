"""Objective of the search for motions on the ground: one motion for each support, all together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.experiments.excitation.limits import MotionLimits
from exoid.experiments.excitation.objective import STEPS, Demand, MotionObjective, box_excesses, narrowed_limits
from exoid.experiments.references import States

from .demands import LIMITS, Demands


@dataclass(frozen=True, eq=False, kw_only=True)
class StanceObjective(MotionObjective):
    """Objective for supports instead of torso tilts, with limits of the ground."""

    demands: tuple[Demands, ...]  # what motions with each support demand
    limits: tuple[MotionLimits, ...]  # limits of the coordinates of each support
    scale: FloatArray  # scale of each parameter, (P,)
    reserve: float = 0.001  # relative margin of what the ground limits, for values between samples
    limit_names = ("angle", "velocity", "acceleration", *LIMITS)

    @property
    def machine(self) -> str:
        """Name of the machine."""
        return self.demands[0].model.leg.description.name

    def coefficients(self, x: FloatArray) -> Sequence[FloatArray]:
        """Split coefficients."""
        sizes = np.cumsum([self.basis.count * one.support.count for one in self.demands])
        return tuple(part.reshape(self.basis.count, -1) for part in np.split(x, sizes[:-1]))

    def excesses_of(self, number: int, states: States) -> FloatArray:
        """Compute the mean squared excess over each limit."""
        demands = self.demands[number]
        squares = (self._short(demands.at(states)) ** 2).mean(axis=1)
        boxes = [box.mean for box in box_excesses(self.limits[number], states)]
        return np.array([*boxes, *np.bincount(demands.kinds, squares, len(LIMITS))])

    def draw(self, rng: np.random.Generator) -> FloatArray:
        """Draw small motions about poses that can be held."""
        parts = []
        for number, (limits, demands) in enumerate(zip(self.limits, self.demands, strict=True)):
            each = rng.standard_normal((self.basis.count, demands.support.count))
            ranges = np.ptp(self.basis.position[:, 1:] @ each[1:], axis=0)
            each[1:] *= 0.1 * rng.uniform(0.3, 1.0) * limits.span / ranges
            q = self.basis.position[:, 1:] @ each[1:]
            held = self._poses_held(number, rng)
            each[0] = held[rng.integers(len(held))] - 0.5 * (q.max(axis=0) + q.min(axis=0))
            parts.append(each.ravel())
        return np.concatenate(parts)

    def narrowed(self) -> StanceObjective:
        """Narrow the limits by the reserve of the search."""
        return replace(self, limits=tuple(map(narrowed_limits, self.limits)), reserve=0.015)  # on the coarser grid

    def _poses_held(self, number: int, rng: np.random.Generator) -> FloatArray:
        """Poses with the largest margins, (K, k)."""
        limits, demands = self.limits[number], self.demands[number]
        y = rng.uniform(limits.lower, limits.upper, (3000, len(limits.lower)))
        margins = demands.at(States(y, np.zeros_like(y), np.zeros_like(y))).margins
        least = margins.min(axis=0)
        if not (least > 0.0).any():
            worst = LIMITS[demands.kinds[int(np.argmin(margins[:, np.argmax(least)]))]]
            raise BadArgumentError(
                f"of {len(y)} poses with support {demands.support.name!r} none is within the limits; the {worst} "
                "limit is exceeded most",
                where=self.machine,
                remedy=f"widen the {worst} limit or the angles, lower the doubt, or give larger soles",
            )
        order = np.argsort(-least)[: min(30, int((least > 0.0).sum()))]
        return np.asarray(y[order])

    def demand(self, number: int, states: States) -> Demand:
        """Compute rows of scaled parameters over their noise, and margins."""
        columns, margins = self.demands[number].at(states)
        return Demand(self._weighted(number, columns, states), margins)

    def slopes(
        self, number: int, states: States, demand: Demand, adjoint: FloatArray, penalty: float
    ) -> tuple[float, States]:
        """Mean squared excess, and the gradient by samples, through columns and margins."""
        short, boxes = self._short(demand), box_excesses(self.limits[number], states)
        by_columns = self._weighted(number, adjoint, states)
        inner = self._through_demands(number, states, by_columns, penalty * 2.0 * short / len(states.q))
        excess = sum(box.mean for box in boxes) + float((short**2).sum()) / len(states.q)
        return excess, States(*(s + penalty * box.slope for s, box in zip(inner, boxes, strict=True)))

    def _weighted(self, number: int, columns: FloatArray, states: States) -> FloatArray:
        """Columns of scaled parameters over the noise of one sample of the basis, (P, k, N); zero in dead bands."""
        demands = self.demands[number]
        directions = demands.support.directions
        variance = directions**2 @ self.noise.per_sample(self.rate) ** 2
        weight = np.sqrt(self.rate * self.seconds / len(self.basis.position) / variance)
        usable = demands.model.usable(demands.support.joints(states).v)[:, demands.model.leg.base_rows :]
        along = (usable[:, None] | (directions == 0.0)).all(axis=2)  # (N, k)
        return np.asarray(columns * self.scale[:, None, None] * weight[:, None] * along.T)

    def _short(self, demand: Demand) -> FloatArray:
        """Missing margins, (C, N), negative or zero."""
        return np.minimum(demand.margins - self.reserve, 0.0)

    def _through_demands(self, number: int, states: States, by_columns: FloatArray, by_margins: FloatArray) -> States:
        """Gradient by samples of the coordinates, given that by demands, by central differences."""
        count, k = states.q.shape
        slopes = []
        for part, step in enumerate(STEPS):
            moved = States(*(np.broadcast_to(x, (k, 2, count, k)).copy() for x in states))
            for j in range(k):  # coordinate, direction, sample, coordinate
                moved[part][j, :, :, j] += np.array([step, -step])[:, None]
            demand = self.demands[number].at(States(*(x.reshape(-1, k) for x in moved)))
            columns, margins = (x.reshape(*x.shape[:-1], -1, count) for x in demand)
            along = np.einsum("pkxs,pks->xs", columns, by_columns) + np.einsum("cxs,cs->xs", margins, by_margins)
            sides = along.reshape(k, 2, count)
            slopes.append((sides[:, 0] - sides[:, 1]).T / (2.0 * step))
        return States(*slopes)
