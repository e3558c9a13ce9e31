"""Demands of a motion on the ground: regressor without unknown wrenches, and margins to the limits of force."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from exoid._typing import FloatArray
from exoid.experiments.excitation.fourier import States
from exoid.experiments.excitation.objective import Demand
from exoid.leg.reduction.planar import GRAVITY
from exoid.torques import TorqueModel

from .limits import GroundLimits
from .support import StanceSupport

LIMITS = ("least load", "most load", "friction", "centre of pressure", "torso", "torque", "clearance")
"""Names of the limits."""


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
        margins = [*self._ground(found.wrench), *upright, *self._torque(rows), *self._clear(joints, torso.pose)]
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

    def _clear(self, joints: States, pose: FloatArray) -> FloatArray:
        """Margins of the feet in the air, (K, N)."""
        return np.asarray((self.support.heights(joints.q, pose).T - self.limits.clearance) / 0.1)  # in units of 0.1 m
