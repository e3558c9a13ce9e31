"""Probability that the loop of one controller is stable, over the distribution of the estimate that it uses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, FloatArray
from exoid.control.law import AnyLaw
from exoid.errors import BadArgumentError
from exoid.estimate import Estimate
from exoid.rig import Wearer
from exoid.tools.json_values import attributes

from .draws import draw_truths
from .worn_loop import NEUTRAL, WornLoop, poses_of


@dataclass(frozen=True, eq=False, repr=False)
class StabilityProbability:
    """Probability that a worn leg is stable under one controller; prints itself."""

    leg: str  # name of the leg
    radius: FloatArray  # largest spectral radius over the poses of each draw, (B,); stable up to 1
    rejected: float  # share of draws that no rigid bodies have
    rate: float  # sampling rate of the controller [Hz]
    delay: int  # delay of the readings in sampling periods

    @property
    def stable(self) -> int:
        """Number of stable draws."""
        return int((self.radius <= 1.0 + NEUTRAL).sum())

    @property
    def probability(self) -> float:
        """Share of stable draws."""
        return self.stable / len(self.radius)

    @property
    def interval(self) -> tuple[float, float]:
        """95 % interval of the probability for the finite number of draws (Clopper and Pearson 1934)."""
        found = scipy.stats.binomtest(self.stable, len(self.radius)).proportion_ci(0.95)
        return float(found.low), float(found.high)

    def to_json(self) -> dict[str, Any]:
        """Convert the result to JSON types."""
        return attributes(self, "leg", "probability", "interval", "rejected", "rate", "delay") | {
            "draws": len(self.radius)
        }

    def __repr__(self) -> str:
        """Write the probability."""
        return f"StabilityProbability({self.leg}: {100.0 * self.probability:.3g} %)"

    def __str__(self) -> str:
        """Print the probability with its Monte-Carlo error."""
        low, high = (100.0 * each for each in self.interval)
        return (
            f"{self.leg}: stable with a probability of {100.0 * self.probability:.3g} % "
            f"({len(self.radius)} draws, Monte-Carlo 95 %: {low:.3g} to {high:.3g} %)\n"
            f"{self.rate:g} Hz, delay {self.delay} sampling periods; linearised without Coulomb friction."
        )


def stability_probability(
    law: AnyLaw,
    estimate: Estimate,
    *,
    wearer: Wearer | None = None,
    poses: ArrayLike | None = None,
    delay: int = 0,
    draws: int = 200,
    seed: int = 0,
) -> StabilityProbability:
    """Compute the probability that a controller is stable, if the truth has the distribution of an estimate.

    Args:
        law: Any controller, with its model inside.
        estimate: Estimate that gives the distribution of the true parameters.
        wearer: The wearer; None for nobody.
        poses: Poses [rad], (N, n) or (n,), at all of which the loop must be stable; None for eight of a stride.
        delay: Delay of the readings in sampling periods.
        draws: Number of draws.
        seed: Seed of the draws.

    Returns:
        Probability with its Monte-Carlo error.

    Raises:
        ExoidError: The number of draws is not positive, too few are physically possible, or the controller has no
            derivatives at a pose.
    """
    if draws < 1:
        raise BadArgumentError(f"{draws} draws", remedy="make at least one")
    loop = WornLoop.of([law], np.zeros(1), wearer, poses_of(estimate.leg, poses), delay)
    model = estimate.model.loaded_by(estimate.values)
    drawn = draw_truths(model, estimate.values, estimate.covariance, draws, seed)
    radius = loop.radius(loop.legs(model, drawn.parameters), np.zeros(draws))
    return StabilityProbability(model.leg.description.name, radius, drawn.rejected, loop.rate, delay)
