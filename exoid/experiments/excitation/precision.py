"""Predicted precision: the covariance of the parameters from motion and torque noise, without measured torques."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.regression.diagnostics import identifiability_class
from exoid.regression.least_squares import INVOLVED, RANK
from exoid.signals import Preparation, Recording, choose_preparation
from exoid.signals.contacts import stands
from exoid.signals.filters.reversals import around_stops, reversal_pulses, without_reversals
from exoid.signals.moving_base import base_during
from exoid.torques import TorqueModel
from exoid.torques.contacts import split
from exoid.torques.contacts.support_model import SupportModel
from exoid.torques.motion import BLOCK

from .scales import Scales, TorqueNoise


@dataclass(frozen=True, eq=False, repr=False)
class Precision:
    """Predicted precision of each parameter.

    Attributes:
        names: Names of the parameters, (P,).
        units: Units of the parameters, (P,).
        covariance: Predicted covariance, with infinite variance of parameters that are not identifiable, (P, P).
        condition_number: Condition number of the weighted regressor with columns of unit length; inf if rank-deficient.
        scales: Scales of the standard deviations.
        duration: Total duration of the motions [s].
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    covariance: FloatArray
    condition_number: float
    scales: Scales
    duration: float

    def __repr__(self) -> str:
        """Write the number of parameters and the worst of them."""
        worst = f"{100.0 * self.worst:.2g} % ({self.names[int(np.argmax(self.relative))]})"
        size = f"{len(self.names)} parameters after {self.duration:g} s"
        return f"Precision({size}: worst relative std {worst}, condition number {self.condition_number:.0f})"

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
            identifiability_class(*each)
            for each in zip(self.scales.expected, self.std, self.scales.parameter_scale, strict=True)
        )


class Information(NamedTuple):
    """Information of rows on the parameters: the two parts of the sandwich covariance."""

    r_factor: FloatArray  # R factor of the weighted rows W̃, (P, P)
    score_covariance: FloatArray  # covariance of the score W̃ᵀε under the noise, Σ_j W̃ᵀ F Fᵀ W̃, (P, P)
    duration: float  # total duration of the motions [s]

    def plus(self, other: Information) -> Information:
        """Combine the information of independent rows."""
        return Information(
            np.asarray(np.linalg.qr(np.vstack([self.r_factor, other.r_factor]), mode="r")),
            self.score_covariance + other.score_covariance,
            self.duration + other.duration,
        )

    def precision(self, model: TorqueModel, scales: Scales) -> Precision:
        """Compute the covariance (Σ W̃ᵀW̃)⁻¹ (Σ_j W̃ᵀ F Fᵀ W̃) (Σ W̃ᵀW̃)⁻¹ of the parameters."""
        scale = np.linalg.norm(self.r_factor, axis=0)
        scale = np.where(scale > 0.0, scale, 1.0)
        padding = np.zeros((len(scale), len(scale)))
        _, sigma, Vt = np.linalg.svd(np.vstack([self.r_factor / scale, padding]), full_matrices=False)
        determined = sigma > RANK * sigma[0]
        V = (Vt[determined].T / sigma[determined]) / scale[:, None]
        condition = float(sigma[0] / sigma[-1]) if determined.all() else np.inf
        inverse = V @ V.T
        covariance = inverse @ self.score_covariance @ inverse
        rounding = np.sqrt(np.maximum(np.diag(covariance), 0.0)) > 1e6 * scales.scale  # information is rounding
        not_determined = np.flatnonzero(rounding | (np.linalg.norm(Vt[~determined], axis=0) > INVOLVED))
        covariance[not_determined] = covariance[:, not_determined] = 0.0
        covariance[not_determined, not_determined] = np.inf
        return Precision(model.names, model.units, covariance, condition, scales, self.duration)


def information_of(
    model: TorqueModel, recordings: Sequence[Recording], noise: TorqueNoise, preparation: Preparation | None = None
) -> Information:
    """Compute the information of motions, with rows W̃ = F W / σ and F the filter of a preparation."""
    if not isinstance(model, SupportModel) and on_ground(model, recordings):
        # Rows are those of `exoid.identify`: of each set of resting links those on which their wrenches do no work.
        # The noise of a row of a closed chain is Σ_j Z_j² σ_j², as its torque is Zᵀ τ. The motion of the base
        # counts as known, as from an IMU. Where feet carry it instead, the unknown compliance of their soles makes
        # intervals up to twice as wide.
        supports = supports_during(model, recordings, preparation)
        each = [information_of(support, parts, noise, preparation) for support, parts in supports]
        if not each:
            raise BadArgumentError("no recordings to predict the precision of", remedy="pass at least one")
        return reduce(Information.plus, each)
    if preparation is None:
        preparation = choose_preparation([model.select(one) for one in recordings])
    count = len(model.names)
    R, score_covariance, duration = np.zeros((0, count)), np.zeros((count, count)), 0.0
    for recording in recordings:
        duration += recording.duration * (1.0 if recording.mask is None else float(np.mean(recording.mask)))
        for W, filtered in _rows(model, recording, noise, preparation):
            R = np.asarray(np.linalg.qr(np.vstack([R, W]), mode="r"))
            score_covariance += filtered.T @ filtered
    return Information(R, score_covariance, duration)


def on_ground(model: TorqueModel, recordings: Iterable[Recording]) -> bool:
    """Tell whether rows are those of a leg on the ground: its base floats, or a log depends on contacts."""
    return bool(model.leg.base_rows) or any(stands(model.leg, model.select(one)) for one in recordings)


def supports_during(
    model: TorqueModel, recordings: Sequence[Recording], preparation: Preparation | None
) -> Iterator[tuple[SupportModel, list[Recording]]]:
    """Sets of links that rest, with the parts of the recordings during which they do."""
    found: dict[tuple[str, ...], list[Recording]] = {}
    for recording in recordings:
        for links, _, part in split(model.leg, model.select(recording), preparation).stretches:
            found.setdefault(links, []).append(part)
    for links, parts in found.items():
        if not links and (model.leg.base_rows or any(one.wrenches for one in parts)):
            raise NotSupportedError(
                "the precision of measured wrenches is not predicted",
                remedy="leave the wrenches of the feet out: their noise is not known",
            )
        q = np.vstack([one.q[one.mask] for one in parts])
        yield SupportModel.of(model, links, q[:: 1 + len(q) // 2000]), parts


def _rows(
    model: TorqueModel, recording: Recording, noise: TorqueNoise, preparation: Preparation
) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Weighted rows W̃ of each joint, and Fᵀ W̃."""
    recording = model.select(recording).resampled()
    rate, of_joints = recording.sample_rate, noise.per_sample(recording.sample_rate)
    edges = np.linspace(0, len(recording), max(1, round(len(recording) / BLOCK)) + 1).astype(int).tolist()
    for block in (recording.slice(*ends) for ends in pairwise(edges)):
        q, v, a, valid = preparation.kinematics(block)
        inside = np.zeros(len(q), dtype=np.bool_)
        inside[valid] = True if block.mask is None else block.mask[valid]
        base = base_during(block, preparation)
        shares = model.row_shares(block.q) if isinstance(model, SupportModel) else None  # (N, n, R)
        std = of_joints if shares is None else np.sqrt((shares[inside] ** 2).mean(axis=0).T @ of_joints**2)
        W, parallel = model.regressor(q, v, a, base) * inside[:, None, None], preparation.parallel(rate)
        W = W if parallel is None else preparation.filter(W, rate)
        use, slow = model.usable(v) & inside[:, None], model.reversing(v)
        if parallel is not None and slow is not None:
            unknown, rows = around_stops(slow, parallel) & inside[:, None], range(len(q))[valid]
            pulses = [reversal_pulses(of_row, parallel) for of_row in unknown.T]
            filtered = list(W[valid].transpose(1, 2, 0))
            for row, (left, _, _) in enumerate(without_reversals(filtered, pulses, rows, parallel)):
                W[valid, row] = left.T
        whole = [W[:, row] * use[:, row, None] / std[row] for row in range(W.shape[1])]
        # Fᵀ, backwards in time
        scores = [np.flip(preparation.filter(np.flip(weighted, axis=0), rate), axis=0) for weighted in whole]
        if shares is not None:  # a torque is in several rows
            each = np.stack([score / std[row] for row, score in enumerate(scores)])
            scores = [of_joints[j] * np.einsum("nr,rnp->np", shares[:, j], each) for j in range(len(of_joints))]
        for row in range(max(len(whole), len(scores))):
            weighted = whole[row][use[:, row]] if row < len(whole) else np.zeros((0, W.shape[2]))
            yield weighted, np.asarray(scores[row]) if row < len(scores) else weighted[:0]
