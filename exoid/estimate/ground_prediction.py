"""Forces of the ground that an estimate predicts from joint torques and motion."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import BoolArray, FloatArray
from exoid.errors import NotIdentifiableError, UnreadableInputError
from exoid.leg.base_kinematics import BaseKinematics
from exoid.leg.leg import Leg
from exoid.leg.link_frames import lowest_point
from exoid.regression.every_row import make_rows
from exoid.regression.intervals import half_width
from exoid.regression.least_squares import RANK
from exoid.signals import Preparation, Recording, Wrench, ZeroPhase, choose_preparation
from exoid.signals.cutoff import noisier, noisier_base, white_noise
from exoid.signals.filters.low_pass import noise_bandwidth
from exoid.signals.filters.parallel import ParallelFilter
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
    of its torque and of the parameters, after both sides have passed a low-pass. Its cut-off is between that of the
    estimate and that of the angles, where noise and what is lost of the component are least. Bands have both. Measured
    wrenches of these links tell contacts, and no more.

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
    if isinstance(estimate.preparation, ZeroPhase):  # touch-downs may be faster than the motion of the training
        rate, own = recording.sample_rate, estimate.preparation
        of_angles = max(each.kinematics_cutoff_at(rate) for each in (own, choose_preparation([recording])))
        estimate = replace(estimate, preparation=ZeroPhase(own.cutoff, of_angles))
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
    """Find the wrenches of one stretch; with a ground, those of steps at a higher cut-off, and bands of all noise."""
    leg, recording, preparation = estimate.model.leg, stretch.recording, estimate.preparation
    rate, mask, rng = recording.sample_rate, recording.mask, np.random.default_rng(0)
    assert mask is not None
    cutoffs, choices, step = list[float](), 1, 1.0  # from the highest; those to choose from; octaves between them
    if isinstance(preparation, ZeroPhase):
        of_angles = preparation.kinematics_cutoff_at(rate)
        octaves = np.log2(of_angles / preparation.cutoff) if ground else 0.0  # noise has to be known to choose by it
        choices = math.ceil(octaves) + 1
        step = octaves / max(1, choices - 1) or 1.0
        cutoffs = [preparation.cutoff * 2.0 ** (octaves - step * k) for k in range(max(choices, 3))]
        preparation = ZeroPhase(cutoffs[0], of_angles)
    passed = _solution(estimate, stretch, feet, preparation)
    noisier = _noisier(leg, ground, recording, rng) if ground else ()
    again = [_solution(estimate, stretch._replace(recording=each), feet, preparation) for each in noisier]
    levels, taken = [passed._replace(noise=np.array([each.wrench - passed.wrench for each in again]))], []
    for cutoff in cutoffs[1:]:
        levels.append(levels[-1].through(ParallelFilter(rate, cutoff), mask))
        taken.append(levels[-2].without(levels[-1], round(rate / cutoff)))
    # What passes one cut-off and not the next is lost there. A touch-down is a step, whose power falls with frequency:
    # what seems more than in the octave below is noise. Beyond the highest cut-off power goes on to fall from octave to
    # octave by the share r by which it fell last, and no slower than that of a step: r + r² + … of the last is lost.
    lost = np.zeros_like(passed.wrench)
    if taken:
        powers = np.maximum([each.mean(axis=0) for each in taken], np.finfo(np.float64).tiny)
        falling = np.minimum.accumulate(powers[::-1])[::-1]
        taken = list(np.array(taken) * (falling / powers)[:, np.newaxis])
        share = np.minimum(falling[0] / falling[1], 2.0**-step)
        lost = taken[0] * share / (1.0 - share)
    best, least = passed.wrench, levels[0].variance + lost
    for level, more in zip(levels[1:choices], taken, strict=False):  # each component up to where it is known best
        lost = lost + more
        variance = level.variance + lost
        better = variance.mean(axis=0) < least.mean(axis=0)
        best, least = np.where(better, level.wrench, best), np.where(better, variance, least)
    half = half_width(0.95, estimate.dof) * np.sqrt(np.maximum(least, 0.0))  # sums leave −1e-45
    forces, time = [], recording.time[mask]
    for k in range(len(feet)):
        wrench, band = (each[:, 6 * k : 6 * k + 6] for each in (best, half))
        forces.append(GroundForce(time, wrench[:, :3], wrench[:, 3:], band[:, :3], band[:, 3:]))
    return forces


class _Passed(NamedTuple):
    """Wrenches of all feet that pass a cut-off, and what makes their error, (N, 6 m) each."""

    wrench: FloatArray  # [N and N·m]
    of_parameters: FloatArray  # variance; infinite where torques do not determine a component
    of_rows: FloatArray  # variance by what is left in the rows of the training, at any cut-off
    white: FloatArray  # variance by white noise of the torques before any filter
    fraction: float  # part of the power of white noise that passes
    noise: FloatArray = np.zeros((0, 1, 1))  # what draws of the noise of motion and ground add, (D, N, 6 m)

    @property
    def variance(self) -> FloatArray:
        """Variance of the wrenches; torques may be noisier than in the training, as larger ones are."""
        of_torques = np.maximum(self.of_rows, self.fraction * self.white)
        of_motion = np.mean(self.noise**2, axis=(0, 1)) if len(self.noise) else 0.0
        return np.asarray(self.of_parameters + of_torques + of_motion)

    def through(self, low_pass: ParallelFilter, mask: BoolArray) -> _Passed:
        """Filter wrenches and noise among the samples of a stretch."""
        every, whole = range(len(mask)), np.zeros((self.wrench.shape[1], len(mask)))
        gain, filtered = low_pass.gain(mask, every), []
        for each in (self.wrench, *self.noise):
            whole[:, mask] = each.T
            filtered.append((low_pass.among_zeros(whole, every, mask) / gain)[:, mask].T)
        fraction = noise_bandwidth(low_pass.rate, low_pass.cutoff)
        return self._replace(wrench=filtered[0], noise=np.array(filtered[1:]), fraction=fraction)

    def without(self, slower: _Passed, samples: int) -> FloatArray:
        """Power of what a lower cut-off takes, around each sample, less that of noise."""
        noise, white = self.noise - slower.noise, (self.fraction - slower.fraction) * self.white.mean(axis=0)
        # over a period of the cut-off: what is taken also passes zero
        power = scipy.ndimage.uniform_filter1d((self.wrench - slower.wrench) ** 2, samples, axis=0)
        of_noise = white + (np.mean(noise**2, axis=(0, 1)) if len(noise) else 0.0)
        share = of_noise / np.maximum(power.mean(axis=0), np.finfo(np.float64).tiny)
        return np.asarray(power * np.maximum(1.0 - share, 0.0))


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


def _solution(estimate: EstimateData, stretch: Stretch, feet: Sequence[str], preparation: Preparation) -> _Passed:
    """Solve J_cᵀ w = W β − [0; τ] at each sample of a stretch, in level axes."""
    leg, recording = estimate.model.leg, stretch.recording
    mask, usual = recording.mask, estimate.preparation.independent_fraction(recording.sample_rate)
    assert mask is not None
    rows, base = make_rows(estimate.model, recording, preparation), base_during(recording, preparation)
    at, W = np.searchsorted(recording.time, rows.time), rows.W
    q, base = rows.q[:, leg.base_rows :], base.rows(at) if isinstance(base, BaseKinematics) else None
    jacobian = np.concatenate([_level_jacobian(leg, q, link, base) for link in feet], axis=1)
    of_joints = np.array([estimate.residual_rms, white_noise(np.asarray(recording.tau))]) ** 2
    of_rows, white = np.hstack([np.zeros((2, leg.base_rows)), of_joints])
    # Weights are those of the errors of each row, at the cut-off of the estimate
    noise = np.maximum(of_rows, usual * white) + parameter_variance(estimate.covariance, W).mean(axis=0)
    size = np.maximum(np.sqrt(noise), np.finfo(np.float64).eps)  # a log without noise has rows without error
    inverse = np.linalg.pinv(np.swapaxes(jacobian, 1, 2) / size[:, np.newaxis], rcond=RANK) / size
    seen = np.einsum("ncr,ncr->nc", inverse, jacobian)  # that of the projector where w = inverse J_cᵀ w holds
    # A component of a wrench counts as seen if this part of it, or less, is lost in the torques
    whole = np.concatenate([_borne(leg, link).diagonal() for link in feet])
    found, of_parameters, of_torques, of_noise = np.zeros((4, len(recording), len(whole)))
    found[at] = np.einsum("ncr,nr->nc", inverse, W @ estimate.values - rows.tau)
    of_parameters[:] = np.inf  # the ends of a log affect other samples: nothing is known of w there
    variance = parameter_variance(estimate.covariance, inverse @ W)
    of_parameters[at] = np.where(seen > whole - 1e-6, variance, np.inf)
    of_torques[at], of_noise[at] = inverse**2 @ of_rows, inverse**2 @ white
    fraction = preparation.independent_fraction(recording.sample_rate)
    return _Passed(found[mask], of_parameters[mask], of_torques[mask], of_noise[mask], fraction)


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
