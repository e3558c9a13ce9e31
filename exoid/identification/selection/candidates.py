"""Ways to identify a leg: how well each predicts what it was not fitted to, and which is chosen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import NotIdentifiableError
from exoid.estimate.estimate import Estimate
from exoid.identification.identify import identify
from exoid.leg.leg import Leg
from exoid.signals import Preparation, Recording, Smoothed, ZeroPhase
from exoid.torques import Term


@dataclass(frozen=True, eq=False)
class Candidate:
    """One way to identify a leg, and how it did."""

    name: str  # short name for tables
    terms: tuple[Term, ...]  # terms of the torque model
    zero: tuple[str, ...]  # names of coefficients of the terms that are held at zero
    preparation: Preparation  # from recordings to rows
    estimator: str = "wls"  # name of the estimator
    numbers: int = 0  # number of parameters that it fits, and of settings that were chosen
    nrmse: FloatArray = field(default_factory=lambda: np.zeros(0))  # NRMSE of each joint over all folds, (n,)
    # NRMSE averaged over the joints, of each fold, relative to the torque of the whole, (K,)
    folds: FloatArray = field(default_factory=lambda: np.zeros(0))
    # NRMSE of the fastest seconds predicted from the slower ones, (n,); not a number where these do not suffice
    extrapolation: FloatArray = field(default_factory=lambda: np.zeros(0))
    failure: str = ""  # why it could not be fitted; empty if it could

    @property
    def fast(self) -> float:
        """Mean of the extrapolation over the joints; not a number where there is none."""
        known = self.extrapolation[np.isfinite(self.extrapolation)]
        return float(known.mean()) if len(known) else np.nan

    @property
    def mean(self) -> float:
        """Mean NRMSE over joints and folds, by which candidates are compared."""
        return np.inf if self.failure else float(self.folds.mean())

    def standard_error(self, best: Candidate) -> float:
        """Standard error of the difference from another candidate, fold by fold."""
        return float(np.std(self.folds - best.folds, ddof=1) / np.sqrt(len(best.folds)))

    def fit(self, leg: Leg, recordings: Recording | Sequence[Recording]) -> Estimate:
        """Identify; coefficients that are left out are held at zero."""
        known = dict.fromkeys(self.zero, 0.0) or None
        return identify(leg, recordings, self.terms, self.estimator, preparation=self.preparation, known=known)

    def others(self, cutoff: float) -> tuple[tuple[Candidate, ...], tuple[Candidate, ...]]:
        """Other filters for the same terms (lower, higher, none for columns and torques), then other estimators."""
        filters: dict[str, Preparation] = {
            f"{factor * cutoff:g} Hz": ZeroPhase(factor * cutoff) for factor in (0.6, 1.5)
        }
        filters["no parallel filter"] = Smoothed(2.0 * cutoff)
        return (
            tuple(replace(self, name=f"{self.name}, {text}", preparation=how) for text, how in filters.items()),
            (replace(self, name=f"{self.name}, huber", estimator="huber"),),
        )

    def to_json(self) -> dict[str, Any]:
        """Turn the figures into what JSON can hold."""
        arrays = {"nrmse": self.nrmse, "folds": self.folds, "fast": self.extrapolation}
        figures = {
            name: [value if np.isfinite(value) else None for value in array.tolist()] for name, array in arrays.items()
        }
        return {"name": self.name, "numbers": self.numbers, **figures, "failure": self.failure}


def least(candidates: Sequence[Candidate]) -> int:
    """Find the smallest mean error."""
    best = int(np.argmin([candidate.mean for candidate in candidates]))
    if candidates[best].failure:
        raise NotIdentifiableError(
            f"no candidate can be fitted: {candidates[0].failure}", remedy="record longer and richer motions"
        )
    return best


def best_of(candidates: Sequence[Candidate]) -> int:
    """Find the one with the fewest numbers among those within one standard error of the best."""
    best = candidates[least(candidates)]
    within = [
        k for k, one in enumerate(candidates) if not one.failure and one.mean - best.mean <= one.standard_error(best)
    ]
    return min(within, key=lambda k: (candidates[k].numbers, k))
