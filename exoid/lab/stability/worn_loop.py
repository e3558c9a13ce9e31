"""A controller, a wearer and poses: everything of the closed loop except the true leg, and its first instability."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exoid._typing import ArrayLike, FloatArray
from exoid.control.law import AnyLaw, refuse_rate
from exoid.control.model import ControlModel
from exoid.errors import BadArgumentError
from exoid.experiments.gait import gait_for_leg, healthy_gait
from exoid.leg.leg import Leg
from exoid.rig import Wearer
from exoid.tools.numbers import ROUNDED
from exoid.torques import TorqueModel

from .linear_law import LinearLaw, linear_law, loop_matrices
from .worn_leg import HeldLeg, LinearLeg, LinearWearer, hold, linear_leg, linear_legs, linear_wearer

LawOf = Callable[[float], AnyLaw]
"""Function that makes a controller from an amplification."""


@dataclass(frozen=True, eq=False)
class WornLoop:
    """Closed loops of a controller and a wearer about several poses; the worst pose counts."""

    # Controllers are linearised at some amplifications α. Between them the matrices are interpolated linearly in the
    # share 1 − 1/α. This is exact for sensitivity amplification, whose torque is linear in the share.

    shares: FloatArray  # shares 1 − 1/α in increasing order, (G,)
    laws: tuple[LinearLaw, ...]  # for each pose, matrices with G along the first axis
    scanned: FloatArray  # amplifications of the scan for the first unstable one, in increasing order
    wearers: tuple[LinearWearer | None, ...]  # the wearer at each pose; None for none
    poses: FloatArray  # poses [rad], (N, n)
    rate: float  # sampling rate [Hz]
    delay: int  # delay of the readings in sampling periods

    @classmethod
    def of(
        cls,
        laws: Sequence[AnyLaw],
        shares: FloatArray,
        wearer: Wearer | None,
        poses: FloatArray,
        delay: int,
        scanned: FloatArray | None = None,
    ) -> WornLoop:
        """Linearise controllers, each of an amplification, and a wearer."""
        rate = laws[0].rate
        refuse_rate(rate)
        at = [[linear_law(law, q) for law in laws] for q in poses]
        stacked = tuple(LinearLaw(*(np.array(each) for each in zip(*row, strict=True))).without_last() for row in at)
        wearers = tuple(None if wearer is None else linear_wearer(wearer, q) for q in poses)
        amplifications = 1.0 / (1.0 - shares) if scanned is None else scanned
        return cls(shares, stacked, amplifications, wearers, poses, rate, delay)

    @classmethod
    def of_amplifications(
        cls, law: LawOf, wearer: Wearer | None, poses: FloatArray, delay: int, most: float
    ) -> WornLoop:
        """Prepare loops with a controller at amplifications between 1 and the largest."""
        scanned = np.geomspace(1.0, most, 9)
        ends = 1.0 - 1.0 / np.array([1.0, most])
        few = np.array([ends[0], ends.mean(), ends[1]])
        loop = cls.of([law(float(1.0 / (1.0 - share))) for share in few], few, wearer, poses, delay, scanned)
        linear = all(  # in the share: the matrices at the middle are the mean of those at the ends
            np.abs(middle - 0.5 * (first + last)).max(initial=0.0) <= 1e-6 * np.abs(last).max(initial=0.0)
            for table in loop.laws
            for first, middle, last in table
        )
        many = np.geomspace(1.0, most, 17)
        laws = [] if linear else [law(float(each)) for each in many]
        return loop if linear else cls.of(laws, 1.0 - 1.0 / many, wearer, poses, delay, scanned)

    def legs(self, model: TorqueModel, parameters: FloatArray) -> list[HeldLeg]:
        """Linearise and sample true legs."""
        return self._held([linear_legs(model, parameters, q) for q in self.poses])

    def legs_of(self, truths: Sequence[ControlModel]) -> list[HeldLeg]:
        """Linearise and sample true legs."""
        at = [[linear_leg(truth, q) for truth in truths] for q in self.poses]
        return self._held([LinearLeg(*map(np.concatenate, zip(*row, strict=True))) for row in at])

    def _held(self, at: Sequence[LinearLeg]) -> list[HeldLeg]:
        return [hold(leg, wearer, 1.0 / self.rate) for leg, wearer in zip(at, self.wearers, strict=True)]

    def radius(self, legs: Sequence[HeldLeg], share: FloatArray) -> FloatArray:
        """Compute the largest spectral radius over the poses."""
        return np.asarray(np.max([np.abs(each).max(axis=-1) for each in self.eigenvalues(legs, share)], axis=0))

    def eigenvalues(self, legs: Sequence[HeldLeg], share: FloatArray) -> list[NDArray[np.complex128]]:
        """Compute the eigenvalues of one period of the loop at each pose."""
        return [
            np.asarray(np.linalg.eigvals(loop_matrices(leg, self._law(table, share), self.delay)), dtype=np.complex128)
            for leg, table in zip(legs, self.laws, strict=True)
        ]

    def largest(self, legs: Sequence[HeldLeg]) -> FloatArray:
        """Find the first unstable amplification from 1 upward, by nodes and then by bisection."""
        count, last = len(legs[0].A), len(self.scanned)
        # legs that became unstable at each pose, the worst is tried first
        unstable = np.zeros(len(legs), dtype=np.int64)
        first = np.full(count, last)
        for node, amplification in enumerate(self.scanned):
            open_ = np.flatnonzero(first == last)
            taken, share = [leg.take(open_) for leg in legs], np.full(len(open_), 1.0 - 1.0 / amplification)
            pose = self._unstable_pose(taken, share, np.argsort(-unstable, kind="stable").tolist())
            first[open_[pose >= 0]] = node
            unstable += np.bincount(pose[pose >= 0], minlength=len(legs))
        found = np.where(first == 0, 0.0, np.inf)
        between = np.flatnonzero((first > 0) & (first < last))
        if len(between):
            taken = [leg.take(between) for leg in legs]
            below, above = self.scanned[first[between] - 1], self.scanned[first[between]]
            for _ in range(12):  # of an interval of 78 % (up to 100), 0.02 % remain
                middle = np.sqrt(below * above)
                pose = self._unstable_pose(taken, 1.0 - 1.0 / middle, np.argsort(-unstable, kind="stable").tolist())
                below, above = np.where(pose < 0, middle, below), np.where(pose < 0, above, middle)
                unstable += np.bincount(pose[pose >= 0], minlength=len(legs))
            found[between] = np.sqrt(below * above)
        return found

    def _unstable_pose(self, legs: Sequence[HeldLeg], share: FloatArray, order: Iterable[int]) -> NDArray[np.int64]:
        """Index of the first pose, in an order, at which each leg is unstable, (B,); −1 for none."""
        found = np.full(len(share), -1)
        for pose in order:
            open_ = np.flatnonzero(found < 0)
            if not len(open_):
                break
            law = self._law(self.laws[pose], share[open_])
            eigenvalues = np.linalg.eigvals(loop_matrices(legs[pose].take(open_), law, self.delay))
            found[open_[np.abs(eigenvalues).max(axis=-1) > 1.0 + ROUNDED]] = pose
        return found

    def _law(self, table: LinearLaw, share: FloatArray) -> LinearLaw:
        """Interpolate the matrices, with B along the first axis."""
        last = len(self.shares) - 1
        upper = np.clip(np.searchsorted(self.shares, share), min(1, last), last)
        lower = np.maximum(upper - 1, 0)
        width = np.where(upper > lower, self.shares[upper] - self.shares[lower], 1.0)
        part = ((share - self.shares[lower]) / width)[:, None, None]
        return LinearLaw(*((1.0 - part) * each[lower] + part * each[upper] for each in table))


def poses_of(leg: Leg, poses: ArrayLike | None, roles: Mapping[str, str] | None = None) -> FloatArray:
    """Take given poses, or poses along a stride, within the limits of the joints."""
    if poses is None:
        gait = gait_for_leg(leg, healthy_gait(scale=1.0, period=1.0), roles)
        return np.array([gait.at(k / 8).q[:, 0] for k in range(8)]).clip(*leg.limits[:2])
    given = np.atleast_2d(np.asarray(poses, dtype=np.float64))
    if given.ndim != 2 or given.shape[1] != len(leg.joint_names) or not np.isfinite(given).all() or not len(given):
        remedy = f"give (N, {len(leg.joint_names)}) angles in rad"
        raise BadArgumentError(f"poses of shape {given.shape}", remedy=remedy)
    return given
