"""Forces of the ground that an estimate predicts from joint torques and motion."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import NotIdentifiableError, UnreadableInputError
from exoid.leg.base_kinematics import BaseKinematics
from exoid.leg.leg import Leg
from exoid.leg.link_frames import lowest_point
from exoid.regression.every_row import make_rows
from exoid.regression.intervals import half_width
from exoid.regression.least_squares import RANK
from exoid.signals import Recording, Wrench
from exoid.signals.cutoff import noisier, noisier_base, white_noise
from exoid.signals.link_wrenches import link_placements, wrenches_on_links
from exoid.signals.moving_base import base_during
from exoid.torques.contacts import split
from exoid.torques.contacts.standing_base import StandingBase
from exoid.torques.contacts.stretches import Stretch, contact_of

from .data import EstimateData
from .ground_validation import Ground, find_ground, in_time_order
from .model_error import parameter_variance


class GroundForce(NamedTuple):
    """Wrench of the ground on one link that rests, in level axes: z up, x and y those of the link at zero angles.

    A point bears no moment, nor a ball where it touches, nor an edge about itself; they turn, and these axes with them.
    Where the base does not float, the axes are those of the laboratory, as the angles say how the link stands. No joint
    torque of a planar leg depends on the force to its side, nor on the moments that it causes. Components that torques
    do not determine are zero with an infinite band.

    Attributes:
        time: Samples at which the link rests [s], (N,).
        force: Force on the link [N], (N, 3).
        moment: Moment about the origin of the link [N·m], (N, 3).
        force_half: Half the width of the 95 % band of the force [N], (N, 3).
        moment_half: Half the width of the 95 % band of the moment [N·m], (N, 3).
    """

    time: FloatArray
    force: FloatArray
    moment: FloatArray
    force_half: FloatArray
    moment_half: FloatArray

    def center_of_pressure(self, height: float = 0.0) -> FloatArray:
        """Find the point of the sole through which the force passes, x = (h f_x − m_y) / f_z, y = (m_x + h f_y) / f_z.

        Args:
            height: Height h of the sole above the origin of the link [m], below zero for a sole beneath it.

        Returns:
            Forward and sideward position from the origin of the link [m], (N, 2); NaN where torques do not determine
            it.
        """
        (fx, fy, fz), (mx, my, _) = self.force.T, self.moment.T
        force, moment = np.isfinite(self.force_half), np.isfinite(self.moment_half)
        seen = np.column_stack([force[:, 0] & force[:, 2] & moment[:, 1], force[:, 1] & force[:, 2] & moment[:, 0]])
        return np.where(seen, np.column_stack([(height * fx - my) / fz, (mx + height * fy) / fz]), np.nan)


def ground_forces(estimate: EstimateData, recording: Recording) -> dict[str, GroundForce]:
    """Predict the wrenches of the ground on resting links from motion and joint torques.

    J_cᵀ w = W β − [0; τ] holds for base and joint rows. It is solved by least squares, each row weighted by the errors
    of its torque and of the parameters, after both sides have passed the filter of the estimate. Measured wrenches of
    these links tell contacts, and no more. Bands miss the force of steps and landings that is faster than this filter.

    Args:
        estimate: Estimate of a leg with a floating base, on a rail, or on a base that is held.
        recording: Motion, torques and contacts.

    Returns:
        Force of each link at the samples at which it rests, where the ends of the recording do not affect them.

    Raises:
        ExoidError: The base does not float, torque is missing, no link rests, or the recording is too short.
    """
    model, leg = estimate.model, estimate.model.leg
    recording = model.select(recording).resampled()
    where, contacts, others = recording.file_name, dict(recording.contacts), {}
    if recording.tau is None or not recording.measured.all():
        raise UnreadableInputError("the torque of a joint is missing", where=where, remedy="record all torques")
    for link, wrench in wrenches_on_links(leg, recording).items():  # those on what rests only tell when it does
        flags = None if link == leg.description.root_link else contact_of(leg, link, wrench)
        if flags is not None:
            contacts.setdefault(link, flags)
        elif link not in contacts:  # such as a harness
            others[link] = wrench
    recording, inside = replace(recording, contacts=contacts, wrenches=others), np.zeros(len(recording), dtype=np.bool_)
    inside[estimate.preparation.kinematics(recording).valid] = True
    settled, parallel = inside, estimate.preparation.parallel(recording.sample_rate)
    if parallel is not None:  # at the ends of a log its low-pass has but one side
        settled = parallel.gain(inside, range(len(inside))) > 0.95
    recording = replace(recording, mask=inside if recording.mask is None else inside & recording.mask)
    found, ground = dict[str, list[GroundForce]](), find_ground(estimate, split(leg, recording, estimate.preparation))
    for stretch in ground.stretches:
        feet = [link for link in stretch.links if link != leg.description.root_link]
        if feet and leg.description.root_link not in stretch.links:
            for link, force in zip(feet, stretch_forces(estimate, ground, stretch, feet), strict=True):
                kept = settled[stretch.recording.mask]
                found.setdefault(link, []).append(GroundForce(*(x[kept] for x in force)))
    if not found:
        remedy = "record contacts of a standing leg"
        raise NotIdentifiableError("no foot carries the leg alone", where=where, remedy=remedy)
    return {link: in_time_order(parts) for link, parts in found.items()}


def level_wrench(
    leg: Leg, q: FloatArray, link: str, wrench: Wrench, rows: NDArray[np.intp] | slice = slice(None)
) -> GroundForce:
    """Turn a wrench in the axes of a link into those of ground forces, to compare it with a predicted one."""
    level, at_origin = level_axes(leg, q[rows], link), wrench.about(np.zeros(3))
    force, moment = (np.einsum("nij,nj->ni", level, x[rows]) for x in (at_origin.force, at_origin.moment))
    return GroundForce(np.arange(len(q), dtype=np.float64)[rows], force, moment, 0.0 * force, 0.0 * force)


def level_axes(leg: Leg, q: FloatArray, link: str) -> FloatArray:
    """Axes of ground forces from those of a link, (N, 3, 3): the laboratory's where the base does not turn."""
    return link_placements(leg, q * (leg.base_rows == 0), link).rotation


def stretch_forces(
    estimate: EstimateData, ground: Ground | None, stretch: Stretch, feet: Sequence[str]
) -> list[GroundForce]:
    """Find the wrenches of one stretch; with a ground, their bands have the noise of angles and base, too."""
    leg, recording = estimate.model.leg, stretch.recording
    assert recording.mask is not None
    (found, std), rng = _solution(estimate, stretch, feet), np.random.default_rng(0)
    noisier = _noisier(leg, ground, stretch.recording, rng) if ground else ()
    again = [_solution(estimate, stretch._replace(recording=each), feet)[0] for each in noisier]
    of_motion = np.mean([(each - found) ** 2 for each in again], axis=(0, 1)) if again else 0.0
    # What a low-pass F takes from a force f, most of it beside a touch-down: f − F f ≈ F f − F F f (Tukey's twicing).
    # At the cut-off that is half of the power, which counts over a period of it: the difference also passes zero.
    smeared, parallel = np.zeros_like(found), estimate.preparation.parallel(recording.sample_rate)
    if parallel is not None:
        once, every = np.zeros((found.shape[1], len(recording))), range(len(recording))
        once[:, recording.mask] = found.T
        twice = parallel.among_zeros(once, every, recording.mask) / parallel.gain(recording.mask, every)
        squares = (once - twice)[:, recording.mask].T ** 2
        smeared = 2.0 * scipy.ndimage.uniform_filter1d(squares, round(parallel.rate / parallel.cutoff), axis=0)
    half = half_width(0.95, estimate.dof) * np.sqrt(np.maximum(std**2 + of_motion + smeared, 0.0))  # sums leave −1e-45
    forces, time = [], recording.time[recording.mask]
    for k in range(len(feet)):
        wrench, band = (each[:, 6 * k : 6 * k + 6] for each in (found, half))
        forces.append(GroundForce(time, wrench[:, :3], wrench[:, 3:], band[:, :3], band[:, 3:]))
    return forces


def _noisier(leg: Leg, ground: Ground, recording: Recording, rng: np.random.Generator) -> Iterator[Recording]:
    """Add the noise of the angles, of wrenches, and of the base where it was measured, once more; lean the ground."""
    base = recording.base
    # Noise is added to a motion three times, to see what it does to forces. The ground changes in each direction once,
    # by √3 of its standard deviation: the mean square of the effects is the sum of those of each.
    root = np.linalg.cholesky(ground.covariance)
    for k in range(3):
        q, wrenches = noisier(recording.q, rng), {}
        for link, wrench in recording.wrenches.items():
            wrenches[link] = replace(wrench, force=noisier(wrench.force, rng), moment=noisier(wrench.moment, rng))
        shaken = replace(recording, q=q, wrenches=wrenches)
        if base is not None and not isinstance(base, StandingBase):
            shaken = replace(shaken, base=replace(noisier_base(base, rng), pose=None))
        yield ground.under(leg, shaken, np.sqrt(3.0) * root[:, k] if k < len(root) else np.zeros(len(root)))


def _solution(estimate: EstimateData, stretch: Stretch, feet: Sequence[str]) -> tuple[FloatArray, FloatArray]:
    """Solve J_cᵀ w = W β − [0; τ] at each sample of a stretch, in level axes: w of all feet and its std, (N, 6 m)."""
    leg, recording, preparation = estimate.model.leg, stretch.recording, estimate.preparation
    assert recording.mask is not None
    rows, base = make_rows(estimate.model, recording, preparation), base_during(recording, preparation)
    at, W = np.searchsorted(recording.time, rows.time), rows.W
    q, base = rows.q[:, leg.base_rows :], base.rows(at) if isinstance(base, BaseKinematics) else None
    jacobian = np.concatenate([_level_jacobian(leg, q, link, base) for link in feet], axis=1)
    # Weights are those of the errors of each row. Torques may be noisier than in the training, as larger ones are.
    white = (
        estimate.preparation.independent_fraction(recording.sample_rate) * white_noise(np.asarray(recording.tau)) ** 2
    )
    noise = np.append(np.zeros(leg.base_rows), np.maximum(estimate.residual_rms**2, white))
    doubt = parameter_variance(estimate.covariance, W).mean(axis=0)
    size = np.maximum(np.sqrt(noise + doubt), np.finfo(np.float64).eps)  # a log without noise has rows without error
    inverse = np.linalg.pinv(np.swapaxes(jacobian, 1, 2) / size[:, np.newaxis], rcond=RANK) / size
    variance = inverse**2 @ noise + parameter_variance(estimate.covariance, inverse @ W)
    seen = np.einsum("ncr,ncr->nc", inverse, jacobian)  # that of the projector where w = inverse J_cᵀ w holds
    # A component of a wrench counts as seen if this part of it, or less, is lost in the torques
    whole = np.concatenate([_borne(leg, link).diagonal() for link in feet])
    # the ends of a log affect other samples: nothing is known of w there
    found, std = np.zeros((len(recording), len(whole))), np.full((len(recording), len(whole)), np.inf)
    found[at] = np.einsum("ncr,nr->nc", inverse, W @ estimate.values - rows.tau)
    std[at] = np.where(seen > whole - 1e-6, np.sqrt(variance), np.inf)
    return found[recording.mask], std[recording.mask]


def _level_jacobian(leg: Leg, q: FloatArray, link: str, base: BaseKinematics | None) -> FloatArray:
    """Jacobian of a link with its rows in level axes, (N, 6, R), without what its contact does not bear."""
    point = lowest_point(leg, q, link, None if base is None else base.up)
    jacobian = leg.frame_jacobian(q, link, point)
    turned = level_axes(leg, q, link)[:, np.newaxis] @ jacobian.reshape(len(q), 2, 3, -1)
    return np.asarray(_borne(leg, link) @ turned.reshape(jacobian.shape))


def _borne(leg: Leg, link: str) -> FloatArray:
    """Projector on what a contact bears of a wrench in level axes, (6, 6)."""
    moments = np.eye(3) - np.outer(leg.plane.lateral, leg.plane.lateral)
    of_kind = {"flat": np.eye(3), "edge": moments, "point": np.zeros((3, 3))}
    return scipy.linalg.block_diag(np.eye(3), of_kind[leg.contact_kind(link)])
