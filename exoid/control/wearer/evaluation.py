"""Torque that the joints need and the actuators do not give, sample by sample, with its variance."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import NotIdentifiableError, UnreadableInputError
from exoid.estimate import EstimateData
from exoid.estimate.compared import compare_rows
from exoid.estimate.evidence import MotionRanges
from exoid.estimate.ground_validation import compare_on_ground
from exoid.regression.rows import Prepared, prepare
from exoid.signals import Preparation, Recording
from exoid.signals.contacts import stands
from exoid.torques import Coulomb

SETTLED = 0.05
"""Near an end of a segment, samples count if the filter of the torques has so little of its weight beyond the end."""


class Evaluation(NamedTuple):
    """Torque of the wearer in one recording."""

    time: FloatArray  # [s], (N,)
    torque: FloatArray  # filtered predicted less filtered measured torque [N·m], (N, n)
    predicted: FloatArray  # filtered predicted torque [N·m], (N, n)
    # variance of the torque where nothing acts [N²·m²], (N, n). Where a joint turns round or rests, its
    # friction may have another value, up to that of sliding
    variance: FloatArray
    noise: FloatArray  # part of it that is noise of the measurement [N²·m²], (n,)
    friction: FloatArray  # part of the predicted torque that is friction [N·m], (N, n); zero on the ground
    ranges: MotionRanges  # ranges of the motion
    # [W τ]ᵀ [W τ] with the columns W of the leg's bodies and rows over their noise, (p + 1, p + 1); None on the ground
    bodies: FloatArray | None = None


def evaluate(estimate: EstimateData, recording: Recording, preparation: Preparation, bandwidth: float) -> Evaluation:
    """Compute τ_w = W β − τ, both sides filtered alike, block by block."""
    if stands(estimate.model.leg, recording):
        compared, ranges = compare_on_ground(estimate, recording, preparation, bandwidth, unknown_wrenches=False)
        torque, variance = compared.predicted - compared.measured, compared.variance
        noise, friction = variance.min(axis=0), 0.0 * torque
        return Evaluation(compared.time, torque, compared.predicted, variance, noise, friction, ranges)
    leg, rubbing = len(estimate.model.leg.parameter_names), np.flatnonzero(estimate.model.friction)
    name, prepared = recording.file_name, prepare(estimate.band_model, recording, preparation, every=True)
    each = compare_rows(estimate, prepared, recording, preparation, bandwidth)
    noise = bandwidth * estimate.noise_variance
    precision = np.where(recording.measured & (noise > 0.0), 1.0 / np.sqrt(np.where(noise > 0.0, noise, 1.0)), 0.0)
    (unknown, dry), bodies, parts = _unknown_friction(estimate, prepared), np.zeros((leg + 1, leg + 1)), []
    for stretch, (rows, of_rows) in zip(prepared.stretches(), each, strict=True):
        keep, share = np.ones(len(rows.time), dtype=np.bool_), np.zeros_like(rows.tau)
        if prepared.parallel is not None:  # rows that have settled, and the share of each torque with unknown friction
            counted = prepared.inside[stretch.start : stretch.stop]
            keep = prepared.parallel.gain(prepared.inside, stretch)[counted] > 1.0 - SETTLED
            share = prepared.parallel.among_zeros(unknown, stretch, prepared.inside).T[counted]
        W, torque = rows.W[keep], (of_rows.predicted - of_rows.measured)[keep]
        table = np.concatenate([W[..., :leg], torque[..., None]], axis=2) * precision[:, None]
        bodies += np.tensordot(table, table, axes=([0, 1], [0, 1]))
        friction = W[..., rubbing] @ estimate.values[rubbing]
        time, predicted, variance = (x[keep] for x in (of_rows.time, of_rows.predicted, of_rows.variance))
        parts.append((time, torque, predicted, variance, friction, share[keep]))
    time, torque, predicted, variance, friction, share = (np.concatenate(part) for part in zip(*parts, strict=True))
    if not len(time):
        what, remedy = "no sample is so far from the ends of the recording that filters have settled", "record longer"
        raise NotIdentifiableError(what, where=name, remedy=f"{remedy}, or choose a higher cut-off")
    if not np.isfinite(torque).all():
        what, remedy = "the estimate gives no finite torque for this motion", "check units and spikes of the angles"
        raise UnreadableInputError(what, where=name, remedy=f"{remedy} (exoid check)")
    size, level = np.where(share < SETTLED, np.abs(friction), np.nan), np.abs(friction).max(axis=0)
    slides = ~np.isnan(size).all(axis=0)
    level[slides] = np.nanmedian(size[:, slides], axis=0)
    # In a slow motion no sample slides so fast that the smooth sign of the model is the whole Coulomb friction
    variance = variance + (np.maximum(level, dry) * share) ** 2 / 3.0  # uniform between −c and c
    ranges = MotionRanges.of(prepared.motion, prepared.inside)
    return Evaluation(time, torque, predicted, variance, noise, friction, ranges, bodies)


def _unknown_friction(estimate: EstimateData, prepared: Prepared) -> tuple[FloatArray, FloatArray]:
    """How unknown friction is at each sample, (n, N), 1 at reversals and rest; Coulomb friction [N·m], (n,)."""
    # A joint that rests may have any friction up to that of sliding. The faster it moves, the less likely it sticks.
    v, values = prepared.motion.v, dict(zip(estimate.names, estimate.values, strict=True))
    dry, speed = np.zeros((2, v.shape[1]))  # of sliding, and speed below which a joint may stick [rad/s]
    for block in estimate.model.blocks:
        if isinstance(block.term, Coulomb):
            dry[list(block.joints)] += abs(sum(values.get(name, 0.0) for name in block.names))
            speed[list(block.joints)] += block.term.reversal_speed
    slow = estimate.model.reversing(v)
    if slow is None:
        return np.zeros_like(v.T), dry
    turns = np.zeros(v.shape, dtype=np.bool_)
    turns[1:] = v[1:] * v[:-1] < 0.0
    turns[:-1] |= turns[1:]
    # A fit takes fewer samples of a slow motion for reversals, but joints stick below the same speed
    slow |= np.abs(v) < speed
    highest = np.max(np.abs(v), axis=0, where=slow & ~turns, initial=1e-12)
    share = np.where(turns, 1.0, np.clip(1.0 - np.abs(v) / highest, 0.0, 1.0))
    return np.ascontiguousarray(np.where(slow, share, 0.0).T), dry
