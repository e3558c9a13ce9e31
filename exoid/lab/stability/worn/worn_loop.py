"""A law, a wearer and poses: everything of the closed loop except the true leg."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.control.law import refuse_rate
from exoid.control.model import ControlModel
from exoid.control.stateful import AnyLaw
from exoid.errors import ExoidError
from exoid.experiments.gait import gait_for_leg, healthy_gait
from exoid.leg.leg import Leg
from exoid.rig import Wearer
from exoid.torques import TorqueModel

from .law_table import LawOf, LawTable
from .linear_leg import LinearLeg, linear_leg, linear_legs
from .linear_wearer import LinearWearer, linear_wearer
from .sampled_loop import HeldLeg, hold

PHASES = 8
"""Number of poses along a stride."""


@dataclass(frozen=True, eq=False)
class WornLoop:
    """Closed loops of one controller and one wearer about several poses; the worst pose counts."""

    table: LawTable  # the controller, linearised
    wearers: tuple[LinearWearer | None, ...]  # the wearer at each pose; None for none
    poses: FloatArray  # poses [rad], (N, n)
    rate: float  # sampling rate [Hz]

    @classmethod
    def of_amplifications(
        cls, law: LawOf, wearer: Wearer | None, poses: FloatArray, delay: int, most: float
    ) -> WornLoop:
        """Prepare loops with a controller at amplifications between 1 and the largest."""
        rate = law(1.0).rate
        _refuse(rate, delay)
        table = LawTable.of_amplifications(law, most, poses, delay)
        return cls(table, _wearers(wearer, poses), poses, rate)

    @classmethod
    def of_law(cls, law: AnyLaw, wearer: Wearer | None, poses: FloatArray, delay: int) -> WornLoop:
        """Prepare loops with one controller, as of share 0."""
        _refuse(law.rate, delay)
        return cls(LawTable.of([law], np.zeros(1), poses, delay), _wearers(wearer, poses), poses, law.rate)

    def legs(self, model: TorqueModel, parameters: FloatArray) -> list[HeldLeg]:
        """Linearise and sample true legs."""
        return self._held([linear_legs(model, parameters, q) for q in self.poses])

    def legs_of(self, truths: Sequence[ControlModel]) -> list[HeldLeg]:
        """Linearise and sample true legs."""
        at = [[linear_leg(truth, q) for truth in truths] for q in self.poses]
        return self._held([LinearLeg(*map(np.concatenate, zip(*row, strict=True))) for row in at])

    def _held(self, at: Sequence[LinearLeg]) -> list[HeldLeg]:
        return [hold(leg, wearer, 1.0 / self.rate) for leg, wearer in zip(at, self.wearers, strict=True)]


def poses_of(leg: Leg, poses: ArrayLike | None) -> FloatArray:
    """Take given poses, or poses along a stride."""
    if poses is None:
        gait = gait_for_leg(leg, healthy_gait(scale=1.0, period=1.0))
        return np.array([gait.at(k / PHASES).q[:, 0] for k in range(PHASES)])
    given = np.atleast_2d(np.asarray(poses, dtype=np.float64))
    if given.ndim != 2 or given.shape[1] != len(leg.joint_names) or not np.isfinite(given).all() or not len(given):
        raise ExoidError(f"poses of shape {given.shape}", remedy=f"give (N, {len(leg.joint_names)}) angles in rad")
    return given


def _wearers(wearer: Wearer | None, poses: FloatArray) -> tuple[LinearWearer | None, ...]:
    return tuple(None if wearer is None else linear_wearer(wearer, q) for q in poses)


def _refuse(rate: float, delay: int) -> None:
    refuse_rate(rate)
    if delay < 0 or delay != int(delay):
        raise ExoidError(f"a delay of {delay} periods", remedy="give a whole number")
