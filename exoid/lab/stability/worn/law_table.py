"""Controller linearised at several amplifications and poses, with the search for the first unstable amplification."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.control.stateful import AnyLaw

from .linear_law import LinearLaw, linear_law
from .sampled_loop import HeldLeg, loop_matrices

NODES = 17
"""Number of amplifications at which a controller is linearised whose torque is not linear in the share."""

SCANNED = 9
"""Number of amplifications of the scan for the first unstable one."""

LINEAR = 1e-6
"""Relative error of interpolated matrices up to which they count as linear in the share."""

BISECTIONS = 12
"""Bisections between two of these: of an interval of 78 % (up to 100), 0.02 % remain."""

NEUTRAL = 1e-9
"""Spectral radius above 1 that is rounding."""

LawOf = Callable[[float], AnyLaw]
"""Function that makes a controller from an amplification."""


@dataclass(frozen=True, eq=False)
class LawTable:
    """Linearised controllers at some amplifications α and poses."""

    # Between them the matrices are interpolated linearly in the share 1 − 1/α. This is exact for sensitivity
    # amplification, whose torque is linear in the share.

    shares: FloatArray  # shares 1 − 1/α in increasing order, (G,)
    poses: tuple[LinearLaw, ...]  # for each pose, matrices with G along the first axis
    delay: int  # delay of the readings in sampling periods
    scanned: FloatArray  # amplifications of the scan for the first unstable one, in increasing order

    @classmethod
    def of(cls, laws: Sequence[AnyLaw], shares: FloatArray, poses: FloatArray, delay: int) -> LawTable:
        """Linearise controllers."""
        at = [[linear_law(law, q) for law in laws] for q in poses]
        stacked = tuple(LinearLaw(*(np.array(each) for each in zip(*row, strict=True))).without_last() for row in at)
        return cls(shares, stacked, delay, 1.0 / (1.0 - shares))

    @classmethod
    def of_amplifications(cls, law: LawOf, most: float, poses: FloatArray, delay: int) -> LawTable:
        """Linearise a controller at amplifications between 1 and the largest."""
        scanned = np.geomspace(1.0, most, SCANNED)
        ends = 1.0 - 1.0 / np.array([1.0, most])
        few = np.array([ends[0], ends.mean(), ends[1]])
        table = cls.of([law(float(1.0 / (1.0 - share))) for share in few], few, poses, delay)
        if not table._is_linear():
            many = np.geomspace(1.0, most, NODES)
            table = cls.of([law(float(each)) for each in many], 1.0 - 1.0 / many, poses, delay)
        return replace(table, scanned=scanned)

    def radius(self, legs: Sequence[HeldLeg], share: FloatArray) -> FloatArray:
        """Compute the largest spectral radius over the poses."""
        return np.asarray(np.max([np.abs(each).max(axis=-1) for each in self.eigenvalues(legs, share)], axis=0))

    def eigenvalues(self, legs: Sequence[HeldLeg], share: FloatArray) -> list[NDArray[np.complex128]]:
        """Compute the eigenvalues of one period of the loop at each pose."""
        return [
            np.asarray(np.linalg.eigvals(loop_matrices(leg, self._law(table, share), self.delay)), dtype=np.complex128)
            for leg, table in zip(legs, self.poses, strict=True)
        ]

    def largest(self, legs: Sequence[HeldLeg]) -> FloatArray:
        """Find the first unstable amplification from 1 upward, by nodes and then by bisection."""
        count, last = len(legs[0].A), len(self.scanned)
        unstable = np.zeros(
            len(legs), dtype=np.int64
        )  # legs that became unstable at each pose, the worst is tried first
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
            for _ in range(BISECTIONS):
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
            law = self._law(self.poses[pose], share[open_])
            eigenvalues = np.linalg.eigvals(loop_matrices(legs[pose].take(open_), law, self.delay))
            found[open_[np.abs(eigenvalues).max(axis=-1) > 1.0 + NEUTRAL]] = pose
        return found

    def _is_linear(self) -> bool:
        """Whether the matrices at the middle of three nodes are the mean of those at the ends."""
        return all(
            np.abs(middle - 0.5 * (first + last)).max(initial=0.0) <= LINEAR * np.abs(last).max(initial=0.0)
            for table in self.poses
            for first, middle, last in table
        )

    def _law(self, table: LinearLaw, share: FloatArray) -> LinearLaw:
        """Interpolate the matrices, with B along the first axis."""
        last = len(self.shares) - 1
        upper = np.clip(np.searchsorted(self.shares, share), min(1, last), last)
        lower = np.maximum(upper - 1, 0)
        width = np.where(upper > lower, self.shares[upper] - self.shares[lower], 1.0)
        part = ((share - self.shares[lower]) / width)[:, None, None]
        return LinearLaw(*((1.0 - part) * each[lower] + part * each[upper] for each in table))
