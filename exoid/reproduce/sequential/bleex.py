"""Document 1's sequential identification of a three-segment leg, one function a step.

Every step takes what is known and returns what is known after it. Parameters have exoid's sign (τ = RNEA +
resistances), so that stiffness and friction are the document's B and C with the opposite sign.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from exoid._typing import ArrayLike
from exoid.errors import ExoidError
from exoid.leg import Leg
from exoid.signals import FiniteDifference, Poses, Preparation, Recording
from exoid.torques import Coulomb, Stiffness, TorqueModel

from .known import Known
from .rows import rows_at_rest, rows_in_motion

HIP, KNEE, ANKLE = 0, 1, 2

FASTER_THAN = 0.08
"""Samples slower than this [rad/s] say nothing on kinetic friction (sec. III-G; the document prints no number)."""

PAIR_TOLERANCE = np.deg2rad(15.0)
"""How far two poses may be from 180° apart [rad]: a soft servo sags by some degrees, and b0 errs accordingly."""


def document_model(leg: Leg) -> TorqueModel:
    """Quadratic stiffness and sharp Coulomb friction at every joint: the document's B and C (eqs. (21), (34)).

    Raises:
        ExoidError: The leg is not a planar chain of three segments.
    """
    if leg.chain is None or leg.chain.n != 3:
        raise ExoidError(
            "document 1's procedure needs a planar leg of hip, knee and ankle",
            where=leg.description.name,
            remedy="use exoid.identify, which works for any leg",
        )
    return TorqueModel(leg, (Stiffness(), Coulomb(smoothing=0.0)))


def stiffness_shape(model: TorqueModel, known: Known, poses: Poses, sets: ArrayLike, joint: int) -> Known:
    """Find b2 and b1 of a joint where gravity is the same within each set of poses (eqs. (18)-(21)).

    For the ankle θ123 is constant within a set, for the knee θ12 and θ3; what gravity and b0 add is one constant a set,
    fitted along and forgotten. Gravity known from other steps is not used.

    Args:
        model: Of :func:`document_model`.
        known: What was found before.
        poses: Averaged over both approach directions.
        sets: Which set each pose belongs to, (K,).
        joint: ANKLE or KNEE.

    Raises:
        ExoidError: There is not one set number a pose, or the poses do not determine the parabola.
    """
    numbers = np.asarray(sets)
    if numbers.shape != (len(poses),):
        raise ExoidError(f"sets has shape {numbers.shape} for {len(poses)} poses", remedy="pass one number a pose")
    label = model.leg.joint_labels[joint]
    shape = (f"b2_{label}", f"b1_{label}")
    rows = rows_at_rest(model, poses, joint)
    own = rows._replace(columns={name: rows.columns[name] for name in shape})
    return known.fit(own, shape, nuisance=(numbers[:, None] == np.unique(numbers)).astype(np.float64))


def ankle_offset(model: TorqueModel, known: Known, pairs: Poses) -> Known:
    """Find b0 of the ankle from pairs of poses 180° apart, whose gravity torques cancel (eqs. (22)-(25)).

    Args:
        model: Of :func:`document_model`.
        known: With b2 and b1 of the ankle.
        pairs: Poses, two and two; θ123 differs by 180° and θ3 not at all.

    Raises:
        ExoidError: The poses are no such pairs.
    """
    _refuse_other_than_pairs(model, pairs)
    label = model.leg.joint_labels[ANKLE]
    rows = rows_at_rest(model, pairs, ANKLE).mean_of_pairs()
    own = {name: column for name, column in rows.columns.items() if name.endswith(f"_{label}")}
    return known.fit(rows._replace(columns=own), (f"b0_{label}",))


def mass_moments(model: TorqueModel, known: Known, poses: Poses, joint: int) -> Known:
    """Find X and Y of the segment below a joint from many poses, the segments below being known (eq. (27)).

    At the knee b0 is found along with them: its pairs would need more than 180° of hip travel, but over poses with
    different θ12 the constant b0 and gravity are told apart by least squares.

    Raises:
        ExoidError: The poses do not determine them, or they are known already.
    """
    label, segment = model.leg.joint_labels[joint], joint + 1
    names = [f"X{segment}", f"Y{segment}"]
    if joint == KNEE:
        names.append(f"b0_{label}")
    return known.fit(rows_at_rest(model, poses, joint).neglecting("c0_"), names)


def inertia(
    model: TorqueModel,
    known: Known,
    recordings: Sequence[Recording],
    segment: int,
    preparation: Preparation | None = None,
) -> Known:
    """Find J of a segment from sinusoids of the joint above it (eqs. (28)-(31)).

    The foot's J3 shows in the torque of the held ankle while the knee swings, the shank's J2 in that of the held knee
    and the thigh's J1 in that of the hip, while the hip swings. Friction is neglected, as the document does: at a held
    joint kinetic friction is zero, but static friction is not. Held joints are taken where they were measured, which is
    the printed equation where they truly stand.

    Args:
        model: Of :func:`document_model`.
        known: With the mass moments and stiffness, and J of the segments below.
        recordings: One for each frequency.
        segment: 3 for the foot, 2 for the shank, 1 for the thigh.
        preparation: Finite differences unless given (sec. III-B2).

    Raises:
        ExoidError: The recordings do not determine J, or have no torque.
    """
    rows = rows_in_motion(model, recordings, segment - 1, preparation or FiniteDifference())
    return known.fit(rows.neglecting("c0_"), [f"J{segment}"])


def kinetic_friction(
    model: TorqueModel,
    known: Known,
    recordings: Sequence[Recording],
    joint: int,
    preparation: Preparation | None = None,
) -> Known:
    """Find c0 of a joint from its own sinusoids, samples near its reversals left out (eqs. (32)-(35)).

    Args:
        model: Of :func:`document_model`.
        known: With everything but the friction.
        recordings: One for each frequency.
        joint: Which swings.
        preparation: Finite differences unless given (sec. III-B2).

    Raises:
        ExoidError: The joint never moves, or the recordings have no torque.
    """
    label = model.leg.joint_labels[joint]
    rows = rows_in_motion(model, recordings, joint, preparation or FiniteDifference())
    return known.fit(rows.where(np.abs(rows.v) > FASTER_THAN), [f"c0_{label}"])


def _refuse_other_than_pairs(model: TorqueModel, poses: Poses) -> None:
    if len(poses) % 2 or not len(poses):
        raise ExoidError(f"{len(poses)} poses are no pairs", remedy="pass two poses for each pair, one after the other")
    q = poses.q[:, [poses.joint_names.index(name) for name in model.leg.joint_names if name in poses.joint_names]]
    apart = q[1::2].sum(axis=1) - q[0::2].sum(axis=1)
    wrong = (np.abs(np.abs(apart) - np.pi) > PAIR_TOLERANCE) | (np.abs(q[1::2, -1] - q[0::2, -1]) > PAIR_TOLERANCE)
    if wrong.any():
        pair = int(wrong.argmax())
        raise ExoidError(
            f"in pair {pair} θ123 differs by {np.rad2deg(apart[pair]):.1f}° and the ankle by "
            f"{np.rad2deg(q[2 * pair + 1, -1] - q[2 * pair, -1]):.1f}°, so that gravity does not cancel",
            remedy="choose poses with θ12 180° apart and the same ankle angle",
        )
