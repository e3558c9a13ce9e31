"""Limb of a passive wearer in compliant cuffs: its motion and its X, Y, J from one log of the worn machine."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.estimate import Estimate, EstimateData
from exoid.identification import identify
from exoid.regression.intervals import half_width
from exoid.regression.rows import for_leg
from exoid.signals import Recording

from .cuffs import Cuffs, estimate_cuffs
from .interaction import Interaction, interaction
from .limb import LimbComparison, late_torque_notes

SETTLED = 0.5
"""Time that is left out at the beginning, in which the filter of the cuffs settles [s]."""


def limb_recording(
    estimate: EstimateData, recording: Recording, stiffness: ArrayLike, damping: ArrayLike = 0.0
) -> Recording:
    """Compute the log of a limb: its angles, and the torques that the leg exerts on it.

    A cuff of stiffness k and damping d exerts τ_w = k (q_l − q) + d (v_l − v), so that the limb's angle is
    q_l = q + τ_w / (k + d s). The leg exerts −τ_w on the limb.

    Args:
        estimate: Estimate of the leg alone.
        recording: Log of the leg with the limb.
        stiffness: Stiffness k of the cuffs at each joint [N·m/rad], one or (n,).
        damping: Damping d of the cuffs [N·m·s/rad], one or (n,).

    Returns:
        Log of the limb, with the leg's joints.

    Raises:
        ExoidError: A stiffness is not positive, a damping is negative, or see :func:`.interaction`.
    """
    cuffs, felt = Cuffs.of(estimate.joint_names, stiffness, damping, 0.0), interaction(estimate, recording)
    return _bent(_leg_log(estimate, recording, felt), felt.torque, cuffs)


def identify_limb(
    estimate: EstimateData,
    recording: Recording,
    stiffness: ArrayLike,
    damping: ArrayLike = 0.0,
    *,
    cuff_std: float = 0.2,
    expected: Mapping[str, float] | None = None,
) -> LimbComparison:
    """Identify X, Y and J of a passive limb in cuffs, and the cuffs as far as the log determines them.

    The limb moves by itself in the cuffs, which :func:`.compare_limb` leaves out. Stated stiffness and damping are
    taken for uncertain: they are estimated beside the limb, with the stated values as prior. Intervals contain what
    remains uncertain of the cuffs. Errors of the leg's parameters count in full: the limb takes over what the leg's
    estimate has too little.

    Args:
        estimate: Estimate of the leg alone.
        recording: Log of the leg with the limb, one segment, on a base that does not move.
        stiffness: Stiffness of the cuffs at each joint [N·m/rad], one or (n,).
        damping: Damping of the cuffs [N·m·s/rad], one or (n,); zero counts as known.
        cuff_std: Relative standard deviation of stiffness and damping as stated; 0 for cuffs that are known exactly.
        expected: Values to compare with, as of :func:`.limb_parameters`.

    Returns:
        Parameters of the limb with 95 % intervals, and the cuffs.

    Raises:
        ExoidError: The base moves, the motion does not determine the limb, or see :func:`limb_recording`.
    """
    if recording.base is not None:
        remedy = "hold the base, or use exoid.wearer.compare_limb"
        raise NotSupportedError("a limb on a base that moves", remedy=remedy)
    cuffs, felt = Cuffs.of(estimate.joint_names, stiffness, damping, cuff_std), interaction(estimate, recording)
    leg, names = _leg_log(estimate, recording, felt), estimate.model.leg.parameter_names
    own = estimate.preparation.describe().get("cutoff")
    cutoff = 0.5 * own if isinstance(own, float) else None  # the torque has passed the interaction's low-pass already

    def identified(log: Recording) -> Estimate:
        return identify(estimate.model.leg, log, terms=(), check=False, cutoff=cutoff)

    found = identified(_bent(leg, felt.torque, cuffs))
    covariance, notes = estimate.covariance[: len(names), : len(names)], late_torque_notes(estimate)
    if not cuffs.known:
        q, v, a, _ = found.preparation.kinematics(leg)
        W = estimate.model.leg.regressor(q, v, a, leg.torso)

        def log_of(some: Cuffs, beta: FloatArray | None) -> Recording:
            return _bent(leg, felt.torque if beta is None else -(W @ beta), some)

        cuffs, of_cuffs, far = estimate_cuffs(cuffs, found, estimate, log_of)
        covariance = covariance + of_cuffs
        found = identified(log_of(cuffs, None))
        notes += (f"the cuffs of {', '.join(far)} differ much from what was stated: check them",) if far else ()
    std = np.sqrt(np.diag(found.covariance + covariance))
    half = half_width(0.95, np.minimum(found.dof_each, estimate.dof_each[: len(names)])) * std
    beside = np.array([(expected or {}).get(name, np.nan) for name in names], dtype=np.float64)
    interval = np.column_stack([found.values - half, found.values + half])
    return LimbComparison(names, found.units, found.values.copy(), std, interval, beside, notes, cuffs)


def _leg_log(estimate: EstimateData, recording: Recording, felt: Interaction) -> Recording:
    """Angles of the leg at the times of the interaction, with the torque that it exerts on the limb."""
    even = for_leg(estimate.model, recording).resampled()
    rate = even.sample_rate
    if np.isnan(felt.torque).any() or np.ptp(np.diff(felt.time)) > 0.5 / rate:
        raise BadArgumentError(
            "the torque of the limb is not known at all joints and times",
            where=felt.source,
            remedy="pass one segment of a recording with all torques",
        )
    used = np.searchsorted(even.time, felt.time - 0.5 / rate)
    return Recording(felt.time, even.q[used], tau=-felt.torque, joint_names=felt.joint_names, torso=even.torso)


def _bent(leg: Recording, torque: FloatArray, cuffs: Cuffs) -> Recording:
    """Log of the limb where a torque (N, n) bends the cuffs by τ / (k + d s) (bilinear transform), once it settled."""
    q = leg.q.copy()
    for j, (k, d) in enumerate(zip(cuffs.stiffness, cuffs.damping, strict=True)):
        b, a = scipy.signal.bilinear([1.0], [d, k], leg.sample_rate) if d else ([1.0 / k], [1.0])
        begin = scipy.signal.lfilter_zi(b, a) * torque[0, j] if d else np.zeros(0)
        q[:, j] += scipy.signal.lfilter(b, a, torque[:, j], zi=begin)[0]
    return replace(leg, q=q).between(float(leg.time[0]) + SETTLED)
