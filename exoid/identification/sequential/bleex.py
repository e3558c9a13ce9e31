"""Document 1's sequential identification of a three-segment leg, one function a step.

Every step takes what is known and returns what is known after it. Parameters have exoid's sign (τ = RNEA +
resistances), so that stiffness and friction are the document's B and C with the opposite sign.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.leg import Leg
from exoid.signals import FiniteDifference, Poses, Preparation, Recording
from exoid.torques import Coulomb, Stiffness, TorqueModel

from .known import Known
from .rows import dynamic_rows, static_rows

HIP, KNEE, ANKLE = 0, 1, 2
FASTER_THAN = 0.08
"""Samples slower than this [rad/s] say nothing on kinetic friction (sec. III-G)."""


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


def stiffness_shape(model: TorqueModel, known: Known, poses: Poses, sets: FloatArray, joint: int) -> Known:
    """Find b2 and b1 of a joint where gravity is the same within each set of poses (eqs. (18)-(21)).

    For the ankle θ123 is constant within a set, for the knee θ12 and θ3; what gravity and b0 add is one constant a set.
    """
    label = model.leg.joint_labels[joint]
    rows = static_rows(model, poses, joint)
    constants = (np.asarray(sets)[:, None] == np.unique(sets)).astype(np.float64)
    shape = (f"b2_{label}", f"b1_{label}")
    return known.fit({name: rows.columns[name] for name in shape}, rows.tau, shape, constants)


def ankle_offset(model: TorqueModel, known: Known, pairs: Poses) -> Known:
    """Find b0 of the ankle from pairs of poses 180° apart, whose gravity torques cancel (eqs. (22)-(25)).

    Args:
        model: The leg.
        known: With b2 and b1 of the ankle.
        pairs: Poses, two and two; θ123 differs by 180° and θ3 not at all.
    """
    label = model.leg.joint_labels[ANKLE]
    rows = static_rows(model, pairs, ANKLE)
    names = (f"b2_{label}", f"b1_{label}", f"b0_{label}")
    columns = {name: 0.5 * (rows.columns[name][0::2] + rows.columns[name][1::2]) for name in names}
    return known.fit(columns, 0.5 * (rows.tau[0::2] + rows.tau[1::2]), names[2:])


def mass_moments(model: TorqueModel, known: Known, poses: Poses, joint: int) -> Known:
    """Find X and Y of the segment below a joint from many poses, the segments below being known (eq. (27)).

    At the knee b0 is found along with them: its pairs would need more than 180° of hip travel, but over poses with
    different θ12 the constant b0 and gravity are told apart by least squares.
    """
    label, segment = model.leg.joint_labels[joint], joint + 1
    rows = static_rows(model, poses, joint)
    names = [f"X{segment}", f"Y{segment}"]
    if joint == KNEE:
        names.append(f"b0_{label}")
    return known.fit(_without_friction(rows.columns), rows.tau, names)


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
    joint it is zero if the joint truly stands, but its static friction is not.
    """
    joint = segment - 1
    rows = dynamic_rows(model, recordings, joint, preparation or FiniteDifference())
    return known.fit(_without_friction(rows.columns), rows.tau, [f"J{segment}"])


def kinetic_friction(
    model: TorqueModel,
    known: Known,
    recordings: Sequence[Recording],
    joint: int,
    preparation: Preparation | None = None,
) -> Known:
    """Find c0 of a joint from its own sinusoids, samples near its reversals left out (eqs. (32)-(35))."""
    label = model.leg.joint_labels[joint]
    rows = dynamic_rows(model, recordings, joint, preparation or FiniteDifference())
    rows = rows.where(np.abs(rows.v[:, joint]) > FASTER_THAN)
    others = _without_friction(rows.columns)
    return known.fit({**others, f"c0_{label}": rows.columns[f"c0_{label}"]}, rows.tau, [f"c0_{label}"])


def _without_friction(columns: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    return {name: column for name, column in columns.items() if not name.startswith("c0_")}
