"""How well parameters will be known: the covariance that identification will have, from motion and noise alone."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.regression.diagnostics import identifiability_class
from exoid.regression.least_squares import INVOLVED, UNDETERMINED
from exoid.regression.rows import for_leg
from exoid.signals import Poses, Preparation, Recording, ZeroPhase
from exoid.torques import TorqueModel

from .noise import TorqueNoise
from .scales import Scales

STRETCH = 2**15
"""Long logs are looked at in stretches of so many samples."""

NOTHING = 1e6
"""A relative standard deviation beyond this comes from rounding: nothing of the parameter was seen."""

READINGS = 50
"""Independent readings that a pose is the mean of, both directions together."""


class StaticRows(NamedTuple):
    """Poses and how often each is read.

    Attributes:
        poses: The poses; their torque does not matter.
        readings: Independent readings that each is the mean of.
    """

    poses: Poses
    readings: int = READINGS


@dataclass(frozen=True, eq=False)
class Precision:
    """What a motion will tell about each parameter.

    Attributes:
        names: Parameters, (P,).
        units: Theirs.
        covariance: Predicted; infinite variance where the motion does not determine a parameter, (P, P).
        condition_number: Of the weighted regressor with columns scaled to unit length; inf where something is unseen.
        scales: What standard deviations are compared with.
        duration: Of the motions [s].
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    covariance: FloatArray
    condition_number: float
    scales: Scales
    duration: float

    @property
    def std(self) -> FloatArray:
        """Predicted standard deviations, (P,)."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @property
    def relative(self) -> FloatArray:
        """Standard deviations over the scales, (P,); see :class:`Scales`."""
        return np.asarray(self.std / self.scales.scale)

    @property
    def worst(self) -> float:
        """Largest relative standard deviation."""
        return float(self.relative.max())

    @property
    def identifiability(self) -> tuple[str, ...]:
        """Predicted class of each parameter: "well", "weakly" or "not", see :attr:`exoid.Estimate.identifiability`."""
        return tuple(
            identifiability_class(*each) for each in zip(self.scales.values, self.std, self.scales.sizes, strict=True)
        )


class Evidence(NamedTuple):
    """All that covariances need of some rows.

    Attributes:
        R: R factor of the weighted rows W̃, (P, P).
        meat: What noise does to them, Σ_j W̃ᵀ F Fᵀ W̃, (P, P).
        duration: Of the motions [s].
    """

    R: FloatArray
    meat: FloatArray
    duration: float

    def with_more(self, other: Evidence) -> Evidence:
        """Evidence of both."""
        return Evidence(_triangle(self.R, other.R), self.meat + other.meat, self.duration + other.duration)

    def precision(self, model: TorqueModel, scales: Scales) -> Precision:
        """Covariance (Σ W̃ᵀW̃)⁻¹ (Σ_j W̃ᵀ F Fᵀ W̃) (Σ W̃ᵀW̃)⁻¹ of the parameters."""
        bread, condition, unseen = _inverse(self.R)
        covariance = bread @ self.meat @ bread
        rounding = np.sqrt(np.maximum(np.diag(covariance), 0.0)) > NOTHING * scales.scale
        unseen = np.flatnonzero(rounding | np.isin(np.arange(len(rounding)), unseen))
        covariance[unseen] = covariance[:, unseen] = 0.0
        covariance[unseen, unseen] = np.inf
        return Precision(model.names, model.units, covariance, condition, scales, self.duration)


def evidence(
    model: TorqueModel,
    data: Iterable[Recording | StaticRows],
    noise: TorqueNoise,
    preparation: Preparation | None = None,
) -> Evidence:
    """Reduce motions and poses to what predictions need: W̃ = F W / σ with F a preparation's filter.

    Args:
        model: Leg and terms.
        data: Motions, whose torques do not enter (of logs that are long, stretch by stretch: each loses its ends to the
            filter), and poses.
        noise: Of the torques, white in front of the filter.
        preparation: As for :func:`exoid.identify`; None for its default.

    Raises:
        ExoidError: A joint is missing, or a motion is too short for the filter.
    """
    preparation, count = preparation or ZeroPhase(), len(model.names)
    R, meat, duration = np.zeros((0, count)), np.zeros((count, count)), 0.0
    for item in data:
        if isinstance(item, Recording):
            duration += item.duration
        for W, spread in _rows(model, item, noise, preparation):
            R = _triangle(R, W)
            meat += spread.T @ spread
    return Evidence(R, meat, duration)


def predict(
    model: TorqueModel,
    data: Iterable[Recording | StaticRows],
    noise: TorqueNoise,
    scales: Scales,
    preparation: Preparation | None = None,
) -> Precision:
    """Predict the covariance that weighted least squares will have; see :func:`evidence`."""
    return evidence(model, data, noise, preparation).precision(model, scales)


def _triangle(*blocks: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.qr(np.vstack(blocks), mode="r"))


def _rows(
    model: TorqueModel, item: Recording | StaticRows, noise: TorqueNoise, preparation: Preparation
) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Weighted rows of each joint, and what the noise of independent samples does to them."""
    if isinstance(item, StaticRows):
        poses = for_leg(model, item.poses)
        still = np.zeros_like(poses.q)
        W = model.regressor(poses.q, still, still, poses.torso) / np.asarray(noise.std)[:, None]
        W *= np.sqrt(item.readings)
        for joint in range(W.shape[1]):
            yield W[:, joint], W[:, joint]
        return
    recording = for_leg(model, item).resampled()
    rate, size = recording.sample_rate, noise.per_sample(recording.sample_rate)
    for stretch in _stretches(recording):
        q, v, a, valid = preparation.kinematics(stretch)
        W = preparation.filter_columns(model.regressor(q, v, a, stretch.torso), rate)
        use = np.zeros(q.shape, dtype=np.bool_)
        use[valid] = model.usable(v)[valid]
        for joint in range(q.shape[1]):
            weighted = W[:, joint] * use[:, joint, None] / size[joint]
            spread = np.flip(preparation.filter(np.flip(weighted, axis=0), rate), axis=0)  # Fᵀ, backwards in time
            yield weighted[use[:, joint]], np.asarray(spread)


def _stretches(recording: Recording) -> Iterator[Recording]:
    count = max(1, round(len(recording) / STRETCH))
    edges = np.linspace(0, len(recording), count + 1).astype(int)
    return (recording.slice(int(b), int(e)) for b, e in pairwise(edges))


def _inverse(R: FloatArray) -> tuple[FloatArray, float, NDArray[np.intp]]:
    """(RᵀR)⁻¹ in the directions that the rows see, the condition number, and which parameters are not seen."""
    scale = np.linalg.norm(R, axis=0)
    scale = np.where(scale > 0.0, scale, 1.0)
    _, sigma, Vt = np.linalg.svd(np.vstack([R / scale, np.zeros((R.shape[1], R.shape[1]))]), full_matrices=False)
    seen = sigma > UNDETERMINED * sigma[0]
    V = (Vt[seen].T / sigma[seen]) / scale[:, None]
    reach = np.linalg.norm(Vt[~seen], axis=0) if not seen.all() else np.zeros(len(sigma))
    condition = float(sigma[0] / sigma[-1]) if seen.all() else np.inf
    return np.asarray(V @ V.T), condition, np.flatnonzero(reach > INVOLVED)
