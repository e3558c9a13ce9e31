"""Objective of the search for motions on the ground: one motion for each support, all together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.experiments.excitation.fourier import Basis, States
from exoid.experiments.excitation.limits import MotionLimits
from exoid.experiments.excitation.noise import TorqueNoise
from exoid.experiments.excitation.objective import (
    STEPS,
    Excess,
    Stage,
    beyond,
    criterion_value,
    narrowed_limits,
)

from .demands import LIMITS, Demand, Demands

CHECKED = 0.001
"""Relative margin that is left on the grid on which limits are checked, for values between its samples."""

RESERVE = 0.015
"""Relative margin that the search keeps on its coarser grid."""

CANDIDATES = 3000
"""Number of poses drawn from which a motion may begin."""

BEST = 30
"""Number of those with the largest margins from which one is taken."""

AMPLITUDE = 0.1
"""Largest size of a drawn motion over the range of angle."""


@dataclass(frozen=True, eq=False)
class StanceObjective:
    """Same as :class:`..objective.Objective` for supports instead of torso tilts, with limits of the ground."""

    demands: tuple[Demands, ...]  # what motions with each support demand
    basis: Basis  # basis functions of the motions
    limits: tuple[MotionLimits, ...]  # limits of the coordinates of each support
    noise: TorqueNoise  # torque noise
    scale: FloatArray  # scale of each parameter, (P,)
    seconds: float  # duration of each motion [s]
    rate: float  # rate of the log [Hz]
    prior_information: FloatArray  # information of other data about scaled parameters, (P, P)
    reserve: float = CHECKED  # relative margin of what the ground limits, for values between samples

    @property
    def pitches(self) -> FloatArray:
        """No tilt of a torso that moves, (T,)."""
        return np.zeros(len(self.demands))

    @property
    def machine(self) -> str:
        """Name of the machine."""
        return self.demands[0].model.leg.description.name

    @property
    def limit_names(self) -> tuple[str, ...]:
        """Names of the limits."""
        return ("angle", "velocity", "acceleration", *LIMITS)

    def __call__(self, x: FloatArray, stage: Stage) -> tuple[float, FloatArray]:
        """Value and gradient at flattened coefficients."""
        motions = [self.basis.states(each) for each in self.coefficients(x)]
        found = [demands.at(states) for demands, states in zip(self.demands, motions, strict=True)]
        weighted = [self._weighted(k, one.columns, motions[k]) for k, one in enumerate(found)]
        information = self.prior_information + sum(np.einsum("pkt,qkt->pq", W, W, optimize=True) for W in weighted)
        value, by_information = criterion_value(information, stage.power)
        gradient = []
        for k, (states, one, W) in enumerate(zip(motions, found, weighted, strict=True)):
            adjoint = self._weighted(k, 2.0 * np.tensordot(by_information, W, axes=1), states)
            short = self._short(one)
            slopes = self._through_demands(k, states, adjoint, stage.penalty * 2.0 * short / len(states.q))
            boxes = self._boxes(k, states)
            value += stage.penalty * (sum(box.mean for box in boxes) + float((short**2).sum()) / len(states.q))
            whole = States(*(s + stage.penalty * box.slope for s, box in zip(slopes, boxes, strict=True)))
            gradient.append(self.basis.coefficient_gradient(whole).ravel())
        return value, np.concatenate(gradient)

    def coefficients(self, x: FloatArray) -> Sequence[FloatArray]:
        """Split coefficients."""
        sizes = np.cumsum([self.basis.count * one.support.count for one in self.demands])
        return tuple(part.reshape(self.basis.count, -1) for part in np.split(x, sizes[:-1]))

    def excesses_of(self, number: int, states: States) -> FloatArray:
        """Compute the mean squared excess over each limit."""
        demands = self.demands[number]
        squares = (self._short(demands.at(states)) ** 2).mean(axis=1)
        boxes = [box.mean for box in self._boxes(number, states)]
        return np.array([*boxes, *np.bincount(demands.kinds, squares, len(LIMITS))])

    def draw(self, rng: np.random.Generator) -> FloatArray:
        """Draw small motions about poses that can be held."""
        parts = []
        for number, (limits, demands) in enumerate(zip(self.limits, self.demands, strict=True)):
            each = rng.standard_normal((self.basis.count, demands.support.count))
            ranges = np.ptp(self.basis.position[:, 1:] @ each[1:], axis=0)
            each[1:] *= AMPLITUDE * rng.uniform(0.3, 1.0) * limits.span / ranges
            q = self.basis.position[:, 1:] @ each[1:]
            held = self._poses_held(number, rng)
            each[0] = held[rng.integers(len(held))] - 0.5 * (q.max(axis=0) + q.min(axis=0))
            parts.append(each.ravel())
        return np.concatenate(parts)

    def narrowed(self) -> StanceObjective:
        """Narrow the limits by the reserve of the search."""
        return replace(self, limits=tuple(map(narrowed_limits, self.limits)), reserve=RESERVE)

    def _poses_held(self, number: int, rng: np.random.Generator) -> FloatArray:
        """Poses with the largest margins, (K, k)."""
        limits, demands = self.limits[number], self.demands[number]
        y = rng.uniform(limits.lower, limits.upper, (CANDIDATES, len(limits.lower)))
        margins = demands.at(States(y, np.zeros_like(y), np.zeros_like(y))).margins
        least = margins.min(axis=0)
        if not (least > 0.0).any():
            worst = LIMITS[demands.kinds[int(np.argmin(margins[:, np.argmax(least)]))]]
            raise ExoidError(
                f"of {CANDIDATES} poses with support {demands.support.name!r} none is within the limits; the {worst} "
                "limit is exceeded most",
                where=self.machine,
                remedy=f"widen the {worst} limit or the angles, lower the doubt, or give larger soles",
            )
        order = np.argsort(-least)[: min(BEST, int((least > 0.0).sum()))]
        return np.asarray(y[order])

    def _weighted(self, number: int, columns: FloatArray, states: States) -> FloatArray:
        """Columns of scaled parameters over the noise of one sample of the basis, (P, k, N); zero in dead bands."""
        demands = self.demands[number]
        directions = demands.support.directions
        variance = directions**2 @ self.noise.per_sample(self.rate) ** 2
        weight = np.sqrt(self.rate * self.seconds / len(self.basis.position) / variance)
        b = demands.model.leg.base_rows
        usable = demands.model.usable(demands.support.joints(states).v)[:, b:]
        along = (usable[:, None] | (directions == 0.0)).all(axis=2)  # (N, k)
        return np.asarray(columns * self.scale[:, None, None] * weight[:, None] * along.T)

    def _short(self, demand: Demand) -> FloatArray:
        """Missing margins, (C, N), negative or zero."""
        return np.minimum(demand.margins - self.reserve, 0.0)

    def _boxes(self, number: int, states: States) -> tuple[Excess, Excess, Excess]:
        """Excess of angles, velocities and accelerations."""
        limits, (q, v, a) = self.limits[number], states
        middle, half = 0.5 * (limits.lower + limits.upper), 0.5 * limits.span
        return beyond(q - middle, half), beyond(v, limits.velocity), beyond(a, limits.acceleration)

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
