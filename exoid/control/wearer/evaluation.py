"""Torque that the joints need and the actuators do not give, sample by sample, with its variance."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import BoolArray, FloatArray
from exoid.errors import ExoidError
from exoid.estimate import EstimateData
from exoid.estimate.ground_validation import compare_on_ground, stands
from exoid.estimate.motion_ranges import MotionRanges
from exoid.regression.every_row import each_row
from exoid.regression.rows import Prepared, prepare, source_of
from exoid.signals import Preparation, Recording

SETTLED = 0.05
"""Near an end of a segment, samples count if the filter of the torques has so little of its weight beyond the end."""


class BodyFit(NamedTuple):
    """Share of the torque that a change of the leg's own bodies would explain, W δ ≈ τ_w by weighted least squares."""

    share: float  # share of the mean square, 0 to 1
    # size of the change along the leg's own torque: −0.2 where the leg is heavier than the estimate by 20 %
    weight: float


class Evaluation(NamedTuple):
    """Torque of the wearer in one recording."""

    time: FloatArray  # [s], (N,)
    torque: FloatArray  # filtered predicted less filtered measured torque [N·m], (N, n)
    predicted: FloatArray  # filtered predicted torque [N·m], (N, n)
    # variance of the torque where nothing acts [N²·m²], (N, n). Where a joint turns round or rests, its
    # friction may have another value, up to that of sliding
    variance: FloatArray
    noise: FloatArray  # part of it that is noise of the measurement [N²·m²], (n,)
    ranges: MotionRanges | None = None  # ranges of the motion; None for a leg on the ground
    bodies: BodyFit | None = None  # what a change of the leg's bodies explains; None for a leg on the ground


def evaluate(estimate: EstimateData, recording: Recording, preparation: Preparation, bandwidth: float) -> Evaluation:
    """Compute τ_w = W β − τ, both sides filtered alike, block by block."""
    if stands(estimate, recording):
        compared = compare_on_ground(estimate, recording, preparation, bandwidth, unknown_wrenches=False)
        torque, variance = compared.predicted - compared.measured, compared.variance
        return Evaluation(compared.time, torque, compared.predicted, variance, variance.min(axis=0))
    model, count = estimate.band_model, len(estimate.values)
    prepared = prepare(model, recording, preparation, every=True)
    joints = len(estimate.joint_names)
    noise = estimate.measured_variance(np.zeros((1, joints, len(model.names))), bandwidth)[0]
    fit = _BodySums(estimate, noise)
    unknown = _unknown_friction(estimate, prepared)
    parts = []
    for stretch, rows in zip(prepared.stretches(), each_row(model, prepared), strict=True):
        keep = _settled(prepared, stretch)
        W, tau = rows.W[keep], rows.tau[keep]
        payload = 0.0 if rows.payload is None else rows.payload[keep]
        predicted = W[..., :count] @ estimate.values
        fit.add(W, predicted - tau)
        variance = estimate.measured_variance(W, bandwidth)
        friction = W[..., :count][..., estimate.model.friction] @ estimate.values[estimate.model.friction]
        share = _share(prepared, unknown, stretch)[keep]
        parts.append((rows.time[keep], predicted - tau, predicted + payload, variance, friction, share))
    time, torque, predicted, variance, friction, share = (np.concatenate(part) for part in zip(*parts, strict=True))
    if not len(time):
        raise ExoidError(
            "no sample is so far from the ends of the recording that filters have settled",
            where=source_of(recording),
            remedy="record longer, or choose a higher cut-off",
        )
    variance = variance + (_sliding_friction(friction, share) * share) ** 2 / 3.0  # uniform between −c and c
    used, motion = prepared.inside, prepared.motion
    if not np.isfinite(torque).all():
        raise ExoidError(
            "the estimate gives no finite torque for this motion",
            where=source_of(recording),
            remedy="check units and spikes of the angles (exoid check)",
        )
    ranges = MotionRanges.of(motion.q[used], motion.v[used], motion.a[used])
    return Evaluation(time, torque, predicted, variance, noise, ranges, fit.result(recording))


def _settled(prepared: Prepared, stretch: range) -> BoolArray:
    """Which rows of a stretch that count are not affected by the ends of a segment, (N,)."""
    counted = prepared.inside[stretch.start : stretch.stop]
    if prepared.parallel is None:
        return np.ones(int(counted.sum()), dtype=np.bool_)
    gain = prepared.parallel.among_zeros(prepared.inside[np.newaxis].astype(np.float64), stretch)[0]
    return np.asarray((gain > 1.0 - SETTLED)[counted])


def _unknown_friction(estimate: EstimateData, prepared: Prepared) -> FloatArray | None:
    """How unknown friction is at each sample, (n, N): 1 at reversals and rest, 0 from the reversal speed."""
    # A joint that rests may have any friction up to that of sliding. The faster it moves, the less likely it sticks.
    v = prepared.motion.v
    slow = estimate.model.reversing(v)
    if slow is None or prepared.parallel is None:
        return None
    turns = np.zeros(v.shape, dtype=np.bool_)
    turns[1:] = v[1:] * v[:-1] < 0.0
    turns[:-1] |= turns[1:]
    highest = np.max(np.abs(v), axis=0, where=slow & ~turns, initial=1e-12)
    share = np.where(turns, 1.0, np.clip(1.0 - np.abs(v) / highest, 0.0, 1.0))
    return np.ascontiguousarray(np.where(slow, share, 0.0).T)


def _share(prepared: Prepared, unknown: FloatArray | None, stretch: range) -> FloatArray:
    """Share of a filtered torque that comes of samples with unknown friction, (N, n)."""
    counted = prepared.inside[stretch.start : stretch.stop]
    if unknown is None or prepared.parallel is None:
        return np.zeros((int(counted.sum()), prepared.tau.shape[1]))
    return prepared.parallel.among_zeros(unknown, stretch, prepared.inside).T[counted]


def _sliding_friction(friction: FloatArray, share: FloatArray) -> FloatArray:
    """Friction of each joint while it slides [N·m], (n,): median of its filtered size."""
    sliding = np.where(share < SETTLED, np.abs(friction), np.nan)
    known = ~np.isnan(sliding).all(axis=0)
    found = np.abs(friction).max(axis=0, initial=0.0)
    found[known] = np.nanmedian(sliding[:, known], axis=0)
    return np.asarray(found)


class _BodySums:
    """Normal equations of the least-squares fit of a change of the leg's bodies to a torque, summed over blocks."""

    def __init__(self, estimate: EstimateData, noise: FloatArray) -> None:
        """Begin with nothing; joints are weighted by their noise."""
        self._leg = len(estimate.model.leg.parameter_names)
        self._values = estimate.values[: self._leg]
        self._scale = np.sqrt(np.where(noise > 0.0, noise, np.inf))
        joints = len(noise)
        self._gram = np.zeros((joints, self._leg, self._leg))
        self._product = np.zeros((joints, self._leg))
        self._square = np.zeros(joints)

    def add(self, W: FloatArray, torque: FloatArray) -> None:
        """Go on with the next rows, (N, n, P), and torques, (N, n)."""
        rows = W[..., : self._leg].transpose(1, 0, 2) / self._scale[:, None, None]
        scaled = torque.T / self._scale[:, None]
        self._gram += rows.transpose(0, 2, 1) @ rows
        self._product += (rows.transpose(0, 2, 1) @ scaled[..., None])[..., 0]
        self._square += (scaled**2).sum(axis=1)

    def result(self, recording: Recording) -> BodyFit:
        """Solve for all joints whose torque was measured."""
        there = recording.measured if len(recording.measured) == len(self._square) else slice(None)
        A, b = self._gram[there].sum(axis=0), self._product[there].sum(axis=0)
        whole, own = float(self._square[there].sum()), float(self._values @ A @ self._values)
        if whole <= 0.0 or own <= 0.0:
            return BodyFit(0.0, 0.0)
        change = np.linalg.lstsq(A, b, rcond=1e-10)[0]
        return BodyFit(float(np.clip(b @ change / whole, 0.0, 1.0)), float(change @ A @ self._values) / own)
