"""Document 1's sequential identification of a three-segment leg, one function a step.

Every step extends the estimate that it receives. Parameters have exoid's sign (τ = RNEA + resistances), so that
stiffness and friction are the document's B and C with the opposite sign.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from exoid._typing import ArrayLike
from exoid.errors import BadArgumentError
from exoid.leg.leg import Leg
from exoid.signals import FiniteDifference, Poses, Recording
from exoid.torques import Coulomb, Stiffness, TorqueModel

from .estimate import SequentialEstimate, planar_model, rows_at_rest, rows_in_motion

HIP, KNEE, ANKLE = 0, 1, 2

MIN_SPEED = 0.08
"""Smallest speed of samples for kinetic friction [rad/s] (doc. 1, sec. III-G, which prints no number)."""


def document_model(leg: Leg) -> TorqueModel:
    """Make the model with quadratic stiffness and sharp Coulomb friction at every joint (doc. 1, eqs. (21), (34))."""
    return planar_model(leg, ("hip", "knee", "ankle"), 1, (Stiffness(), Coulomb(smoothing=0.0)))


def stiffness_coefficients(
    model: TorqueModel, known: SequentialEstimate, poses: Poses, sets: ArrayLike, joint: int
) -> SequentialEstimate:
    """Identify b2 and b1 of a joint from sets of poses with constant gravity torque (doc. 1, eqs. (18)-(21))."""
    # Within a set θ123 is constant for the ankle, θ12 and θ3 for the knee. Gravity and b0 are one nuisance constant a
    # set. Gravity parameters of other steps are not used.
    numbers = np.asarray(sets)
    if numbers.shape != (len(poses),):
        raise BadArgumentError(
            f"sets has shape {numbers.shape} for {len(poses)} poses", remedy="pass one number a pose"
        )
    label = model.leg.joint_labels[joint]
    names = (f"b2_{label}", f"b1_{label}")
    rows = rows_at_rest(model, poses, joint)
    own = rows._replace(columns={name: rows.columns[name] for name in names})
    return known.fit(own, names, nuisance=(numbers[:, None] == np.unique(numbers)).astype(np.float64))


def ankle_offset(model: TorqueModel, known: SequentialEstimate, pairs: Poses) -> SequentialEstimate:
    """Identify b0 of the ankle: gravity torques of poses 180° apart cancel (doc. 1, eqs. (22)-(25))."""
    if len(pairs) % 2 or not len(pairs):
        raise BadArgumentError(f"{len(pairs)} poses are not pairs", remedy="pass two consecutive poses for each pair")
    q = pairs.q[:, [pairs.joint_names.index(name) for name in model.leg.joint_names if name in pairs.joint_names]]
    apart, ankle = q[1::2].sum(axis=1) - q[0::2].sum(axis=1), q[1::2, -1] - q[0::2, -1]
    # a soft servo sags by some degrees, which biases b0
    wrong = np.maximum(np.abs(np.abs(apart) - np.pi), np.abs(ankle)) > np.deg2rad(15.0)
    if wrong.any():
        pair = int(wrong.argmax())
        raise BadArgumentError(
            f"in pair {pair} θ123 differs by {np.rad2deg(apart[pair]):.1f}° and the ankle by "
            f"{np.rad2deg(ankle[pair]):.1f}°: gravity does not cancel",
            remedy="choose poses with θ12 180° apart and the same ankle angle",
        )
    label = model.leg.joint_labels[ANKLE]
    rows = rows_at_rest(model, pairs, ANKLE).mean_of_pairs()
    own = {name: column for name, column in rows.columns.items() if name.endswith(f"_{label}")}
    return known.fit(rows._replace(columns=own), (f"b0_{label}",))


def mass_moments(model: TorqueModel, known: SequentialEstimate, poses: Poses, joint: int) -> SequentialEstimate:
    """Identify X and Y of the segment below a joint from many poses (doc. 1, eq. (27))."""
    # The segments further down are known. At the knee b0 is identified too: pairs of poses would need more than 180° of
    # hip travel, but least squares over poses with different θ12 separates b0 from gravity.
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
) -> SequentialEstimate:
    """Identify J of a segment from sinusoids (doc. 1, eqs. (28)-(31))."""
    # J3 of the foot follows from the torque of the held ankle while the knee swings. J2 of the shank follows
    # from that of the held knee and J1 of the thigh from that of the hip, while the hip swings. Friction is
    # neglected as in the document: kinetic friction is zero at a held joint, but static friction is not. Held
    # joints enter with their measured angles; at constant angles this is the printed equation.
    rows = rows_in_motion(model, recordings, segment - 1, FiniteDifference())
    return known.fit(rows.neglecting("c0_"), [f"J{segment}"])


def kinetic_friction(
    model: TorqueModel,
    known: SequentialEstimate,
    recordings: Sequence[Recording],
    joint: int,
) -> SequentialEstimate:
    """Identify c0 of a joint from its sinusoids without samples near the reversals (doc. 1, eqs. (32)-(35))."""
    label = model.leg.joint_labels[joint]
    rows = rows_in_motion(model, recordings, joint, FiniteDifference())
    return known.fit(rows.where(np.abs(rows.v) > MIN_SPEED), [f"c0_{label}"])
