"""Prediction of the torques of a leg that stands, without what forces of the ground may add to them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import reduce
from typing import NamedTuple, TypeVar

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import NotSupportedError
from exoid.leg.base_kinematics import BaseKinematics
from exoid.leg.leg import Leg
from exoid.leg.reduction.planar import GRAVITY
from exoid.regression.every_row import each_row, make_rows
from exoid.regression.rows import chain, prepare
from exoid.signals import Preparation, Recording
from exoid.signals.moving_base import base_during
from exoid.torques.contacts import split
from exoid.torques.contacts.elimination import eliminate
from exoid.torques.contacts.standing_base import LEVEL as TILT
from exoid.torques.contacts.standing_base import StandingBase, standing_base
from exoid.torques.contacts.stretches import Split, Stretch
from exoid.torques.contacts.support_model import LOOP, SupportModel

from .compared import Compared, wrench_variance
from .data import EstimateData
from .evidence import MotionRanges
from .model_error import parameter_variance

FORCE = 0.2  # standard deviation of the bias of a sensor that no foot told [m/s²]
PIECE, BLOCK = 0.25, 1.5
"""Time in which a foot that rocks leans alike [s], and time beyond which the noise of rows is not correlated [s]: a
stride, whose touch-downs are alike."""

T = TypeVar("T", bound=tuple[FloatArray, ...])


def compare_on_ground(
    estimate: EstimateData,
    recording: Recording,
    preparation: Preparation,
    bandwidth: float,
    *,
    unknown_wrenches: bool = True,
) -> tuple[Compared, MotionRanges]:
    """Predict the torques of a recording with contacts, and tell the ranges of its motion."""
    # Where one link rests by an unknown wrench, the base hangs on it, and each joint has a torque. Where
    # several do, only the part Z Zᵀ τ can be predicted, on which no force of the ground does work: that is
    # compared.
    leg = estimate.model.leg
    # where wrenches are measured throughout, a torque of a wearer would pass for a lean
    parts = split(leg, estimate.model.select(recording), preparation)
    ground = find_ground(estimate, parts, measured=unknown_wrenches)
    stretches = ground.stretches
    if not unknown_wrenches:
        resting = {link for stretch in stretches for link in stretch.links} - {leg.description.root_link}
        stretches = tuple(each for each in stretches if not {*each.links} & resting)
        if not stretches:
            raise NotSupportedError(
                f"{', '.join(sorted(resting))} on the ground throughout, and the wrenches there were not measured",
                where=recording.file_name,
                remedy=f"record the wrenches (columns wrench_{min(resting)}_fx to _mz), or the leg in the air",
            )
    found = [_compare(estimate, ground, stretch, preparation, bandwidth) for stretch in stretches]
    return in_time_order([one for one, _ in found]), reduce(MotionRanges.joined, (ranges for _, ranges in found))


class Ground(NamedTuple):
    """Ground under a recording: its lean, or what the sensor on the base is off by, as feet took it for level."""

    stretches: Sequence[Stretch]  # those of the recording, whose base moves as it does on this ground
    directions: FloatArray = np.zeros((0, 3))  # rotation vectors [rad], or specific forces [m/s²], (K, 3)
    values: FloatArray = np.zeros(0)  # multiples of these, (K,)
    covariance: FloatArray = np.zeros((0, 0))  # covariance at each time, with that of a foot that rocks, (K, K)

    def under(self, leg: Leg, recording: Recording, more: FloatArray) -> Recording:
        """Let the base of a recording move as on a ground with these values, and more in this one."""
        base = recording.base
        if isinstance(base, StandingBase):
            base = standing_base(leg, recording, base.link, lean=(self.values + more) @ self.directions)
        elif base is not None:
            base = replace(base, specific_force=base.specific_force - more @ self.directions)
        return replace(recording, base=base)


def find_ground(estimate: EstimateData, parts: Split, *, measured: bool = False) -> Ground:
    """Find how the ground under a recording leans, or the bias of its sensor, from its torques."""
    # τ − W β = −D c + noise, D by differences, c ~ N(0, σ²), gives c and what β leaves open of it. How pieces of the
    # recording differ tells how a foot rocks, and how far the mean of c is off.
    leg, preparation = estimate.model.leg, estimate.preparation
    stretches, base = parts.stretches, parts.stretches[0].recording.base
    stands, spatial = isinstance(base, StandingBase), leg.base_rows == 6
    if stands:
        directions, size = (np.eye(3)[:2] if spatial else leg.plane.lateral[np.newaxis]), TILT
    elif not leg.base_rows or base is None or base.pose is not None or base.calibrated:
        return Ground(stretches)
    else:
        directions = np.eye(3) if spatial else np.array([leg.plane.forward, leg.plane.up])
        size = FORCE if parts.imu is None or parts.imu.rocks else GRAVITY * TILT
    count = len(directions)
    values, prior = np.zeros(count), size**-2.0 * np.eye(count)
    ground = Ground(stretches, directions, values, size**2 * np.eye(count))
    for _ in range(2):  # a lean of 3° is so large that its sine is not linear
        found = []
        for stretch in stretches:
            recording = stretch.recording
            if not (stretch.links or measured) or recording.tau is None or not recording.measured.all():
                continue
            support = SupportModel.of(estimate.model, stretch.links, recording.q[recording.mask])
            steps = values + size * np.vstack([np.zeros(count), np.eye(count)])
            rows = [make_rows(support, ground.under(leg, recording, step), preparation) for step in steps]
            noise = _of_rows(estimate.residual_variance, estimate.joint_names, support.row_names)
            q = recording.q[recording.mask]
            of_wrenches = wrench_variance(estimate, recording, preparation, q, stretch.links, support.axes)
            noise = noise + of_wrenches.mean(axis=0)
            weights = np.maximum(noise, 1e-18) ** -0.5  # logs may have no noise
            left, *moved = (weights * (each.tau - each.W @ estimate.values) for each in rows)
            D = np.stack([left - each for each in moved], axis=-1) / size
            starts = np.flatnonzero(np.diff(np.floor(rows[0].time / PIECE), prepend=np.nan))
            others = D, (left + D @ values)[..., np.newaxis], weights[:, np.newaxis] * rows[0].W
            found.append(tuple(np.add.reduceat(np.einsum("nrk,nrp->nkp", D, other), starts) for other in others))
        if not found:
            return ground
        known, scores, of_values = (np.concatenate(parts) for parts in zip(*found, strict=True))
        inverse = np.linalg.inv(known.sum(axis=0) + prior)
        values = (inverse @ scores.sum(axis=0))[:, 0]
    slopes = inverse @ of_values.sum(axis=0)
    apart = np.linalg.solve(known + prior, scores - known @ values[:, np.newaxis])[..., 0]
    share = 1.0 if stands else min(1.0, BLOCK / (PIECE * len(apart)))
    covariance = inverse + slopes @ estimate.covariance @ slopes.T + share * apart.T @ apart / len(apart)
    stretches = tuple(each._replace(recording=ground.under(leg, each.recording, values)) for each in stretches)
    return Ground(stretches, directions, values, covariance)


def in_time_order(parts: Sequence[T]) -> T:
    """Put arrays of several stretches together, in order of the time that stands first."""
    order = np.argsort(np.concatenate([part[0] for part in parts]), kind="stable")
    return type(parts[0])(*(np.concatenate(arrays)[order] for arrays in zip(*parts, strict=True)))


def _compare(
    estimate: EstimateData, ground: Ground, stretch: Stretch, preparation: Preparation, bandwidth: float
) -> tuple[Compared, MotionRanges]:
    """Predict the torques while the same links rest."""
    links, recording, values = stretch.links, stretch.recording, estimate.values
    bare, support = (
        SupportModel.of(model, links, recording.q[recording.mask]) for model in (estimate.model, estimate.band_model)
    )
    axes, prepared = support.axes, prepare(support, recording, preparation, every=True)
    rows = chain(list(each_row(support, prepared)))
    known = np.zeros_like(rows.tau) if rows.known is None else rows.known
    W = rows.W[..., : len(values)]
    measured, predicted = rows.tau + known, W @ values + known
    at = np.searchsorted(recording.time, rows.time)
    q = recording.q[at]
    variance = parameter_variance(estimate.covariance, W)
    variance += bandwidth * _of_rows(estimate.noise_variance, estimate.joint_names, support.row_names)
    if estimate.model_error is not None:
        variance += estimate.model_error.variance(rows.W)
    for step in np.linalg.cholesky(ground.covariance).T:  # what is not known of the ground, direction by direction
        moved = make_rows(bare, ground.under(bare.leg, recording, step), preparation)
        variance += (moved.tau - moved.W @ values + predicted - measured) ** 2
    variance = variance + wrench_variance(estimate, recording, preparation, q, links, axes)
    if axes is not None:
        base = base_during(recording, preparation)
        base = base.rows(at) if isinstance(base, BaseKinematics) else None
        loop = eliminate(estimate.model.leg, links, q, axes, base).loop
        assert loop is not None
        parts = (np.einsum("njr,nr->nj", loop, part) for part in (measured, predicted, known))
        measured, predicted, known = parts
        variance = np.einsum("njr,nr->nj", loop**2, variance)
    joints = slice(measured.shape[1] - len(estimate.joint_names), None)  # rows of the base stand before them, if any
    compared = Compared(rows.time, *(part[:, joints] for part in (measured, predicted, variance, known)))
    return compared, MotionRanges.of(prepared.motion, prepared.inside)


def _of_rows(of_joints: FloatArray, joints: Sequence[str], rows: Sequence[str]) -> FloatArray:
    """Variance of each row: that of its joint, of closed chains the mean of all, of a base unknown, (R,)."""
    known, whole = dict(zip(joints, of_joints.tolist(), strict=True)), float(of_joints.mean())
    return np.array([whole if name.startswith(LOOP) else known.get(name, np.inf) for name in rows])
