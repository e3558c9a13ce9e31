"""Limb of a passive wearer in compliant cuffs: its motion and its X, Y, J from one log of the worn machine."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError
from exoid.estimate import EstimateData
from exoid.identification import identify
from exoid.regression.intervals import half_width
from exoid.regression.rows import for_leg
from exoid.signals import Recording

from .interaction import interaction
from .limb import LimbComparison

SETTLED = 0.5
"""Time that is left out at the beginning, in which the filter of the cuffs settles [s]."""

SHARE = 0.5
"""Cut-off of the limb's identification over that of the interaction, whose low-pass its torque has passed already."""


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
    found = interaction(estimate, recording)
    joints = len(found.joint_names)
    k, d = (np.broadcast_to(np.asarray(x, dtype=np.float64), joints) for x in (stiffness, damping))
    if not (np.isfinite(k).all() and np.isfinite(d).all() and k.min() > 0.0 and d.min() >= 0.0):
        raise ExoidError(
            f"cuffs of {stiffness!r} N·m/rad and {damping!r} N·m·s/rad",
            remedy="give a positive stiffness, such as 1000",
        )
    even = for_leg(estimate.model, recording).resampled()
    rate = even.sample_rate
    if np.isnan(found.torque).any() or np.ptp(np.diff(found.time)) > 0.5 / rate:
        raise ExoidError(
            "the torque of the limb is not known at all joints and times",
            where=found.source,
            remedy="pass one segment of a recording with all torques",
        )
    used = np.searchsorted(even.time, found.time - 0.5 / rate)
    bent = np.column_stack([_bent(x, each, other, rate) for x, each, other in zip(found.torque.T, k, d, strict=True)])
    log = Recording(found.time, even.q[used] + bent, tau=-found.torque, joint_names=found.joint_names, torso=even.torso)
    return log.between(float(found.time[0]) + SETTLED)


def identify_limb(
    estimate: EstimateData,
    recording: Recording,
    stiffness: ArrayLike,
    damping: ArrayLike = 0.0,
    *,
    expected: Mapping[str, float] | None = None,
) -> LimbComparison:
    """Identify X, Y and J of a passive limb in cuffs of known stiffness.

    The limb moves by itself in the cuffs, which :func:`.compare_limb` leaves out. Errors of the leg's parameters count
    in full: the limb takes over what the leg's estimate has too little.

    Args:
        estimate: Estimate of the leg alone.
        recording: Log of the leg with the limb, one segment, on a base that does not move.
        stiffness: Stiffness of the cuffs at each joint [N·m/rad], one or (n,).
        damping: Damping of the cuffs [N·m·s/rad], one or (n,).
        expected: Values to compare with, as of :func:`.limb_parameters`.

    Returns:
        Parameters of the limb with 95 % intervals.

    Raises:
        ExoidError: The base moves, the motion does not determine the limb, or see :func:`limb_recording`.
    """
    if recording.base is not None:
        raise ExoidError("a limb on a base that moves", remedy="hold the base, or use exoid.wearer.compare_limb")
    log = limb_recording(estimate, recording, stiffness, damping)
    leg = estimate.model.leg
    own = estimate.preparation.describe().get("cutoff")
    found = identify(leg, log, terms=(), check=False, cutoff=SHARE * own if isinstance(own, float) else None)
    count = len(leg.parameter_names)
    std = np.sqrt(np.diag(found.covariance + estimate.covariance[:count, :count]))
    half = half_width(0.95, np.minimum(found.dof_each, estimate.dof_each[:count])) * std
    beside = np.array([(expected or {}).get(name, np.nan) for name in leg.parameter_names], dtype=np.float64)
    interval = np.column_stack([found.values - half, found.values + half])
    return LimbComparison(leg.parameter_names, found.units, found.values.copy(), std, interval, beside)


def _bent(torque: FloatArray, stiffness: float, damping: float, rate: float) -> FloatArray:
    """Pass a torque through 1 / (k + d s), by the bilinear transform."""
    b, a = scipy.signal.bilinear([1.0], [damping, stiffness], rate) if damping else ([1.0 / stiffness], [1.0])
    begin = scipy.signal.lfilter_zi(b, a) * torque[0] if damping else np.zeros(0)
    return np.asarray(scipy.signal.lfilter(b, a, torque, zi=begin)[0])
