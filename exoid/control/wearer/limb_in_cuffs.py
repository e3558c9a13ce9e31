"""Limb of a passive wearer in compliant cuffs: its motion and its X, Y, J from one log of the worn machine."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError
from exoid.estimate import Estimate, EstimateData
from exoid.identification import identify
from exoid.regression.intervals import half_width
from exoid.regression.rows import for_leg
from exoid.signals import Recording

from .cuffs import Cuffs, LimbLogs, estimate_cuffs
from .interaction import Interaction, interaction
from .limb import LimbComparison, late_torque_notes

SETTLED = 0.5
"""Time that is left out at the beginning, in which the filter of the cuffs settles [s]."""

SHARE = 0.5
"""Cut-off of the limb's identification over that of the interaction, whose low-pass its torque has passed already."""

CUFF_STD = 0.2
"""Default relative standard deviation of stiffness and damping of the cuffs."""


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
    leg = _leg_log(estimate, recording, felt)
    return _bent_by(leg, felt.torque, cuffs).between(float(leg.time[0]) + SETTLED)


def identify_limb(
    estimate: EstimateData,
    recording: Recording,
    stiffness: ArrayLike,
    damping: ArrayLike = 0.0,
    *,
    cuff_std: float = CUFF_STD,
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
        raise ExoidError("a limb on a base that moves", remedy="hold the base, or use exoid.wearer.compare_limb")
    cuffs, felt = Cuffs.of(estimate.joint_names, stiffness, damping, cuff_std), interaction(estimate, recording)

    leg = _leg_log(estimate, recording, felt)

    def log_of(some: Cuffs) -> Recording:
        return _bent_by(leg, felt.torque, some).between(float(leg.time[0]) + SETTLED)

    found, count = _identified(estimate, log_of(cuffs)), len(estimate.model.leg.parameter_names)
    covariance, notes = estimate.covariance[:count, :count], late_torque_notes(estimate)
    if not cuffs.known:
        q, v, a, _ = found.preparation.kinematics(leg)
        W = estimate.model.leg.regressor(q, v, a, leg.torso)

        def predicted(some: Cuffs, beta: FloatArray) -> Recording:
            return _bent_by(leg, -(W @ beta), some).between(float(leg.time[0]) + SETTLED)

        of_cuffs = estimate_cuffs(cuffs, found, estimate, LimbLogs(log_of, predicted))
        cuffs, covariance = of_cuffs.cuffs, covariance + of_cuffs.limb_covariance
        found = _identified(estimate, log_of(cuffs))
        far = ", ".join(of_cuffs.far)
        notes += (f"the cuffs of {far} differ much from what was stated: check them",) if far else ()
    std = np.sqrt(np.diag(found.covariance + covariance))
    half = half_width(0.95, np.minimum(found.dof_each, estimate.dof_each[:count])) * std
    names = estimate.model.leg.parameter_names
    beside = np.array([(expected or {}).get(name, np.nan) for name in names], dtype=np.float64)
    interval = np.column_stack([found.values - half, found.values + half])
    return LimbComparison(names, found.units, found.values.copy(), std, interval, beside, notes, cuffs)


def _identified(estimate: EstimateData, log: Recording) -> Estimate:
    """Identify the limb from its log."""
    own = estimate.preparation.describe().get("cutoff")
    cutoff = SHARE * own if isinstance(own, float) else None
    return identify(estimate.model.leg, log, terms=(), check=False, cutoff=cutoff)


def _leg_log(estimate: EstimateData, recording: Recording, felt: Interaction) -> Recording:
    """Angles of the leg at the times of the interaction, with the torque that it exerts on the limb."""
    even = for_leg(estimate.model, recording).resampled()
    rate = even.sample_rate
    if np.isnan(felt.torque).any() or np.ptp(np.diff(felt.time)) > 0.5 / rate:
        raise ExoidError(
            "the torque of the limb is not known at all joints and times",
            where=felt.source,
            remedy="pass one segment of a recording with all torques",
        )
    used = np.searchsorted(even.time, felt.time - 0.5 / rate)
    return Recording(felt.time, even.q[used], tau=-felt.torque, joint_names=felt.joint_names, torso=even.torso)


def _bent_by(leg: Recording, torque: FloatArray, cuffs: Cuffs) -> Recording:
    """Angles of the limb where a torque bends the cuffs."""
    columns = zip(torque.T, cuffs.stiffness, cuffs.damping, strict=True)
    return replace(leg, q=leg.q + np.column_stack([_bent(x, k, d, leg.sample_rate) for x, k, d in columns]))


def _bent(torque: FloatArray, stiffness: float, damping: float, rate: float) -> FloatArray:
    """Pass a torque through 1 / (k + d s), by the bilinear transform."""
    b, a = scipy.signal.bilinear([1.0], [damping, stiffness], rate) if damping else ([1.0 / stiffness], [1.0])
    begin = scipy.signal.lfilter_zi(b, a) * torque[0] if damping else np.zeros(0)
    return np.asarray(scipy.signal.lfilter(b, a, torque, zi=begin)[0])
