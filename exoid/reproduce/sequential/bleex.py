"""Document 1's sequential identification of a three-segment leg, one function a step.

Every step extends the estimate that it receives. Parameters have exoid's sign (τ = RNEA + resistances), so that
stiffness and friction are the document's B and C with the opposite sign.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from exoid._typing import ArrayLike
from exoid.errors import ExoidError
from exoid.leg import Leg
from exoid.signals import FiniteDifference, Poses, Preparation, Recording
from exoid.torques import Coulomb, Stiffness, TorqueModel

from .estimate import SequentialEstimate
from .rows import planar_model, rows_at_rest, rows_in_motion

HIP, KNEE, ANKLE = 0, 1, 2

MIN_SPEED = 0.08
"""Smallest speed of samples for kinetic friction [rad/s] (doc. 1, sec. III-G, which prints no number)."""

PAIR_TOLERANCE = np.deg2rad(15.0)
"""Tolerance of the 180° between paired poses [rad]; a soft servo sags by some degrees, which biases b0."""


def document_model(leg: Leg) -> TorqueModel:
    """Make the model with quadratic stiffness and sharp Coulomb friction at every joint (doc. 1, eqs. (21), (34)).

    Args:
        leg: Planar leg with hip, knee and ankle.

    Returns:
        Leg and terms.

    Raises:
        ExoidError: The leg is not a planar chain of three segments.
    """
    return planar_model(leg, ("hip", "knee", "ankle"), 1, (Stiffness(), Coulomb(smoothing=0.0)))


def stiffness_coefficients(
    model: TorqueModel, known: SequentialEstimate, poses: Poses, sets: ArrayLike, joint: int
) -> SequentialEstimate:
    """Identify b2 and b1 of a joint from sets of poses with constant gravity torque (doc. 1, eqs. (18)-(21)).

    Within a set θ123 is constant for the ankle, θ12 and θ3 for the knee. Gravity and b0 are one nuisance constant a
    set. Gravity parameters of other steps are not used.

    Args:
        model: Model of :func:`document_model`.
        known: Estimate so far.
        poses: Poses, averaged over both directions of approach.
        sets: Number of the set of each pose, (K,).
        joint: Joint, ANKLE or KNEE.

    Returns:
        Estimate with b2 and b1.

    Raises:
        ExoidError: The length of ``sets`` differs from that of ``poses``, or the poses do not determine the parabola.
    """
    numbers = np.asarray(sets)
    if numbers.shape != (len(poses),):
        raise ExoidError(f"sets has shape {numbers.shape} for {len(poses)} poses", remedy="pass one number a pose")
    label = model.leg.joint_labels[joint]
    names = (f"b2_{label}", f"b1_{label}")
    rows = rows_at_rest(model, poses, joint)
    own = rows._replace(columns={name: rows.columns[name] for name in names})
    return known.fit(own, names, nuisance=(numbers[:, None] == np.unique(numbers)).astype(np.float64))


def ankle_offset(model: TorqueModel, known: SequentialEstimate, pairs: Poses) -> SequentialEstimate:
    """Identify b0 of the ankle from pairs of poses 180° apart, whose gravity torques cancel (doc. 1, eqs. (22)-(25)).

    Args:
        model: Model of :func:`document_model`.
        known: Estimate with b2 and b1 of the ankle.
        pairs: Poses in consecutive pairs with the same θ3 and θ123 180° apart.

    Returns:
        Estimate with b0 of the ankle.

    Raises:
        ExoidError: The poses are not such pairs.
    """
    _refuse_other_than_pairs(model, pairs)
    label = model.leg.joint_labels[ANKLE]
    rows = rows_at_rest(model, pairs, ANKLE).mean_of_pairs()
    own = {name: column for name, column in rows.columns.items() if name.endswith(f"_{label}")}
    return known.fit(rows._replace(columns=own), (f"b0_{label}",))


def mass_moments(model: TorqueModel, known: SequentialEstimate, poses: Poses, joint: int) -> SequentialEstimate:
    """Identify X and Y of the segment below a joint from many poses (doc. 1, eq. (27)).

    The segments further down are known. At the knee b0 is identified too: pairs of poses would need more than 180° of
    hip travel, but least squares over poses with different θ12 separates b0 from gravity.

    Args:
        model: Model of :func:`document_model`.
        known: Estimate with the segments further down and the stiffness of the joint.
        poses: Poses, averaged over both directions of approach.
        joint: Joint, HIP, KNEE or ANKLE.

    Returns:
        Estimate with X and Y, at the knee also b0.

    Raises:
        ExoidError: The poses do not determine the parameters, or these are already known.
    """
    label, segment = model.leg.joint_labels[joint], joint + 1
    names = [f"X{segment}", f"Y{segment}"]
    if joint == KNEE:
        names.append(f"b0_{label}")
    return known.fit(rows_at_rest(model, poses, joint).neglecting("c0_"), names)


def inertia(
    model: TorqueModel,
    known: SequentialEstimate,
    recordings: Sequence[Recording],
    segment: int,
    preparation: Preparation | None = None,
) -> SequentialEstimate:
    """Identify J of a segment from sinusoids (doc. 1, eqs. (28)-(31)).

    J3 of the foot follows from the torque of the held ankle while the knee swings. J2 of the shank follows from that of
    the held knee and J1 of the thigh from that of the hip, while the hip swings. Friction is neglected as in the
    document: kinetic friction is zero at a held joint, but static friction is not. Held joints enter with their
    measured angles; at constant angles this is the printed equation.

    Args:
        model: Model of :func:`document_model`.
        known: Estimate with mass moments, stiffness, and J of the segments further down.
        recordings: One recording for each frequency.
        segment: Segment: 3 for the foot, 2 for the shank, 1 for the thigh.
        preparation: Preparation; None for finite differences (doc. 1, sec. III-B2).

    Returns:
        Estimate with J of the segment.

    Raises:
        ExoidError: The recordings do not determine J, or have no torque.
    """
    rows = rows_in_motion(model, recordings, segment - 1, preparation or FiniteDifference())
    return known.fit(rows.neglecting("c0_"), [f"J{segment}"])


def kinetic_friction(
    model: TorqueModel,
    known: SequentialEstimate,
    recordings: Sequence[Recording],
    joint: int,
    preparation: Preparation | None = None,
) -> SequentialEstimate:
    """Identify c0 of a joint from its sinusoids without samples near the reversals (doc. 1, eqs. (32)-(35)).

    Args:
        model: Model of :func:`document_model`.
        known: Estimate with all other parameters.
        recordings: One recording for each frequency.
        joint: Joint that swings.
        preparation: Preparation; None for finite differences (doc. 1, sec. III-B2).

    Returns:
        Estimate with c0 of the joint.

    Raises:
        ExoidError: The joint never moves, or the recordings have no torque.
    """
    label = model.leg.joint_labels[joint]
    rows = rows_in_motion(model, recordings, joint, preparation or FiniteDifference())
    return known.fit(rows.where(np.abs(rows.v) > MIN_SPEED), [f"c0_{label}"])


def _refuse_other_than_pairs(model: TorqueModel, poses: Poses) -> None:
    if len(poses) % 2 or not len(poses):
        raise ExoidError(f"{len(poses)} poses are not pairs", remedy="pass two consecutive poses for each pair")
    q = poses.q[:, [poses.joint_names.index(name) for name in model.leg.joint_names if name in poses.joint_names]]
    apart = q[1::2].sum(axis=1) - q[0::2].sum(axis=1)
    wrong = (np.abs(np.abs(apart) - np.pi) > PAIR_TOLERANCE) | (np.abs(q[1::2, -1] - q[0::2, -1]) > PAIR_TOLERANCE)
    if wrong.any():
        pair = int(wrong.argmax())
        raise ExoidError(
            f"in pair {pair} θ123 differs by {np.rad2deg(apart[pair]):.1f}° and the ankle by "
            f"{np.rad2deg(q[2 * pair + 1, -1] - q[2 * pair, -1]):.1f}°: gravity does not cancel",
            remedy="choose poses with θ12 180° apart and the same ankle angle",
        )
