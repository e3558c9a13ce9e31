"""Demands of a motion on the ground: rows without unknown wrenches, margins to limits, and what can be determined."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.experiments.excitation.limits import MotionLimits
from exoid.experiments.excitation.objective import Demand
from exoid.experiments.excitation.scales import STATES, Scales, reference_states
from exoid.experiments.references import States
from exoid.leg.reduction.planar import GRAVITY
from exoid.regression.least_squares import INVOLVED, RANK
from exoid.tools.numbers import checked
from exoid.torques import TorqueModel

from .support import StanceSupport

LIMITS = ("least load", "most load", "friction", "centre of pressure", "torso", "torque", "clearance")
"""Names of the limits."""


EVERY = "all of them can be determined"
"""End of the sentence about supports that leave nothing undetermined."""


@dataclass(frozen=True)
class GroundLimits:
    """Limits of ground force, torso, knees and feet.

    Attributes:
        friction: Coefficient of friction that a motion may use, below that of the ground.
        sole_margin: Distance of the centre of pressure from heel and toe [m].
        least_load: Smallest vertical force over the weight of the machine.
        most_load: Largest vertical force over the weight.
        doubt: Relative standard deviation of each expected parameter of the rigid bodies. Limits of force and torque
            are kept at twice the standard deviation that it causes.
        bow_deg: Largest pitch of the torso forward [deg].
        recline_deg: Largest pitch of the torso backward [deg].
        knee_deg: Smallest flexion of a knee [deg]: at a straight knee a foot leaves no row of the equation.
        clearance: Smallest height of a foot that does not stand [m].

    Raises:
        ExoidError: A number is negative, not finite, or contradicts another.
    """

    friction: float = 0.4
    sole_margin: float = 0.02
    least_load: float = 0.5
    most_load: float = 1.5
    doubt: float = 0.05
    bow_deg: float = 40.0
    recline_deg: float = 10.0
    knee_deg: float = 15.0
    clearance: float = 0.03

    def __post_init__(self) -> None:
        """Check the numbers."""
        for field in fields(self):
            checked(getattr(self, field.name), field.name, least=0.0)
        if not (self.friction > 0.0 and self.least_load < 1.0 < self.most_load and self.doubt < 0.5):
            raise BadArgumentError(
                f"friction {self.friction:g}, load from {self.least_load:g} to {self.most_load:g} of the weight, "
                f"doubt {self.doubt:g}",
                remedy="friction is above 0, the load at rest is 1, and a doubt is less than 0.5",
            )


@dataclass(frozen=True, eq=False)
class Demands:
    """Demands of motions with one support."""

    support: StanceSupport  # feet that stand
    model: TorqueModel  # torque model of the machine
    expected: FloatArray  # expected parameters, (P,)
    torque: FloatArray  # largest torque of the joints [N·m], (n,)
    limits: GroundLimits  # limits of the ground force and of the feet

    @property
    def weight(self) -> float:
        """Weight of the machine [N]."""
        return GRAVITY * float(self.expected[0])

    @cached_property
    def kinds(self) -> tuple[int, ...]:
        """Place of the limit of each margin in :data:`LIMITS`, (C,)."""
        points = sum(len(leg.sole) for leg in self.support.swings)
        return (0, 1, 2, 2, 3, 3, 4, 4, *(5,) * self.support.count, *(6,) * points)

    def at(self, states: States) -> Demand:
        """Compute the demands of a motion; rows of the torques along the coordinates are not scaled."""
        support = self.support
        joints = support.joints(states)
        torso = support.torso(joints)
        full = self.model.columns(self.model.motion(*joints, torso.kinematics))
        found = support.ground_rows(joints, full)
        rows = np.matmul(support.directions, found.torque)
        pitch = torso.pose[:, 2]
        upright = [pitch + np.deg2rad(self.limits.bow_deg), np.deg2rad(self.limits.recline_deg) - pitch]
        margins = [*self._ground(found.wrench), *upright, *self._torque(rows)]
        # margins of the feet in the air, in units of 0.1 m
        margins += [*((support.heights(joints.q, torso.pose).T - self.limits.clearance) / 0.1)]
        return Demand(rows, np.array(margins))

    def _ground(self, wrench: FloatArray) -> list[FloatArray]:
        """Margins of the ground force and of the centre of pressure, for rows (p, 3, N)."""
        forward, up, moment = (wrench * self.expected[: len(wrench), None, None]).transpose(1, 0, 2)
        points, limits = self.support.stands[0].sole, self.limits  # from the ankle
        heel, toe, height = points.real.min(), points.real.max(), points.imag.mean()
        reach = 0.5 * (toe - heel)
        # about a point (x, height) of the sole the moment is about - x · up
        about = moment + height * forward
        margins = [
            self._sure(up) - limits.least_load * self.weight,
            limits.most_load * self.weight - self._sure(up, -1.0),
            self._sure(up - forward / limits.friction),
            self._sure(up + forward / limits.friction),
            self._sure(about / reach - (heel + limits.sole_margin) / reach * up),
            self._sure((toe - limits.sole_margin) / reach * up - about / reach),
        ]
        return [margin / self.weight for margin in margins]

    def _sure(self, terms: FloatArray, side: float = 1.0) -> FloatArray:
        """Sum Σ_p g_p π_p of terms (P, N) less (or plus) what doubts may take, 2 doubt √(Σ_p (g_p π_p)²), (N,)."""
        spread = np.sqrt(np.einsum("pn,pn->n", terms, terms))
        return np.asarray(terms.sum(axis=0) - side * 2.0 * self.limits.doubt * spread)

    def _torque(self, rows: FloatArray) -> FloatArray:
        """Margins of the torques; feet that stand share them, (k, N)."""
        terms = rows * self.expected[:, None, None]
        spread = 2.0 * self.limits.doubt * np.sqrt(np.einsum("pkn,pkn->kn", terms, terms))
        shared = np.linalg.norm(self.support.spread, axis=1)
        own = np.where(self.support.spread != 0.0, self.torque, np.inf).min(axis=1)
        return np.asarray(1.0 - (np.abs(terms.sum(axis=0)) + spread) / (own * shared)[:, None])


def null_space(demands: Sequence[Demands], limits: Sequence[MotionLimits], scale: FloatArray) -> FloatArray:
    """Find combinations of parameters that no motion with these supports determines."""
    rng, rows = np.random.default_rng(0), []
    for one, box in zip(demands, limits, strict=True):
        states = reference_states(box, 400, rng)
        columns = one.at(states).columns * scale[:, None, None]
        rows.append(columns.reshape(len(scale), -1).T)
    W = np.linalg.qr(np.vstack(rows), mode="r")
    size = np.linalg.norm(W, axis=0)
    size = np.where(size > RANK * size.max(), size, size.max())  # a foot at rest leaves only rounding
    _, sigma, Vt = np.linalg.svd(W / size)
    loose = Vt[sigma <= RANK * sigma[0]].T / size[:, None]
    return np.asarray(np.linalg.qr(loose)[0])


def undetermined(names: Sequence[str], null: FloatArray) -> tuple[str, ...]:
    """Name the parameters that are part of such combinations."""
    part = np.linalg.norm(null, axis=1)
    return tuple(name for name, size in zip(names, part, strict=True) if size > INVOLVED)


def missing_support(names: Sequence[str], loose: Sequence[str], added: Sequence[str], null: FloatArray) -> str:
    """Say what motions with further supports would determine."""
    still = set(undetermined(names, null))
    more = [name for name in loose if name not in still]
    if not more or not added:
        return ""
    what = EVERY if len(more) == len(loose) else f"{', '.join(more)} can be determined"
    return f"with motions on {' and '.join(added)} as well: {what}"


def stance_scales(demands: Sequence[Demands], limits: Sequence[MotionLimits]) -> Scales:
    """Compute the scales over random states of standing on each foot, see :class:`Scales`."""
    rng, tables = np.random.default_rng(0), []
    for one, box in zip(demands, limits, strict=True):
        inverse = np.linalg.inv(one.support.spread)  # of one foot: a permutation of the joints
        columns = one.at(reference_states(box, STATES, rng)).columns
        tables.append(np.einsum("jk,pks->sjp", inverse, columns))
    return Scales.over(demands[0].expected, np.vstack(tables))
