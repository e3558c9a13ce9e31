"""How candidates did, and which of them is chosen."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .candidates import Candidate


class Score(NamedTuple):
    """How a candidate did.

    Attributes:
        candidate: Candidate model.
        numbers: Number of parameters that it fits, nonlinear ones too.
        nrmse: NRMSE of each joint over all folds, (n,).
        folds: NRMSE averaged over the joints, of each fold, relative to the torque of the whole, (K,).
        extrapolation: NRMSE of the fastest seconds predicted from the slower ones, (n,); not a number where these do
            not suffice.
        failure: Why it could not be fitted; empty if it could.
    """

    candidate: Candidate
    numbers: int
    nrmse: FloatArray
    folds: FloatArray
    extrapolation: FloatArray
    failure: str = ""

    @classmethod
    def failed(cls, candidate: Candidate, joints: int, folds: int, why: str) -> Score:
        """Make the score of a candidate that could not be fitted.

        Args:
            candidate: The candidate.
            joints: Number of joints.
            folds: Number of folds.
            why: The reason.

        Returns:
            A score without figures.
        """
        return cls(candidate, 0, np.full(joints, np.nan), np.full(folds, np.nan), np.full(joints, np.nan), why)

    @property
    def fast(self) -> float:
        """Mean of :attr:`extrapolation` over the joints whose torque was measured; not a number where there is none."""
        known = self.extrapolation[np.isfinite(self.extrapolation)]
        return float(known.mean()) if len(known) else np.nan

    @property
    def mean(self) -> float:
        """Mean NRMSE over joints and folds, by which candidates are compared."""
        return float(self.folds.mean())


def least(scores: Sequence[Score]) -> int:
    """Find the smallest mean error."""
    means = np.array([np.inf if score.failure else score.mean for score in scores])
    if not np.isfinite(means).any():
        raise ExoidError(f"no candidate can be fitted: {scores[0].failure}", remedy="record longer and richer motions")
    return int(np.argmin(means))


def best_of(scores: Sequence[Score]) -> int:
    """Find the one with the fewest numbers among those within one standard error of the best."""
    best = scores[least(scores)]
    within = [k for k, s in enumerate(scores) if not s.failure and s.mean - best.mean <= standard_error(s, best)]
    return min(within, key=lambda k: (scores[k].numbers, k))


def standard_error(score: Score, best: Score) -> float:
    """Standard error of the difference of two candidates, fold by fold."""
    return float(np.std(score.folds - best.folds, ddof=1) / np.sqrt(len(best.folds)))
