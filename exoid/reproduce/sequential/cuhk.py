"""Document 2's identification of a two-segment leg, one function for each row of its Table II.

Every step takes what is known and returns what is known after it. Here the document's own sign is exoid's: dissipative
friction is positive (its Table III prints the opposite).
"""

from __future__ import annotations

import numpy as np

from exoid.errors import ExoidError
from exoid.leg import Leg
from exoid.signals import MovingAverage, Poses, Preparation, Recording
from exoid.torques import Coulomb, Stiffness, TorqueModel, Viscous

from .known import Known
from .rows import rows_at_rest, rows_in_motion

HIP, KNEE = 0, 1


def document_model(leg: Leg) -> TorqueModel:
    """Linear stiffness, Coulomb and viscous friction at both joints (eq. (6), Table III).

    Raises:
        ExoidError: The leg is not a planar chain of two segments.
    """
    if leg.chain is None or leg.chain.n != 2:
        raise ExoidError(
            "document 2's procedure needs a planar leg of hip and knee",
            where=leg.description.name,
            remedy="use exoid.identify, which works for any leg",
        )
    return TorqueModel(leg, (Stiffness(degree=1), Coulomb(smoothing=0.0), Viscous()))


def knee_stiffness(model: TorqueModel, known: Known, poses: Poses) -> Known:
    """Row 1: slope b1 of the knee over poses of constant Δ, at which the knee's gravity torque is the same (eq. (21)).

    The hip's stiffness cannot be found like that: its gravity torque changes with θh (eq. (20)). The document sets it
    to zero.

    Args:
        model: Of :func:`document_model`.
        known: What was found before.
        poses: Of constant Δ.

    Raises:
        ExoidError: The poses do not determine the slope.
    """
    rows = rows_at_rest(model, poses, KNEE)
    name = f"b1_{model.leg.joint_labels[KNEE]}"
    own = rows._replace(columns={name: rows.columns[name]})
    return known.fit(own, [name], nuisance=np.ones((len(rows.tau), 1)))


def mass_moments(model: TorqueModel, known: Known, poses: Poses) -> Known:
    """Row 2: X2, Y2 and the knee's constant from the knee's torque, then X1 and Y1 from the hip's (eqs. (20)-(21)).

    Raises:
        ExoidError: The poses do not determine them.
    """
    label = model.leg.joint_labels[KNEE]
    known = known.fit(rows_at_rest(model, poses, KNEE), ["X2", "Y2", f"b0_{label}"])
    return known.fit(rows_at_rest(model, poses, HIP), ["X1", "Y1"])


def inertias(model: TorqueModel, known: Known, recording: Recording, preparation: Preparation | None = None) -> Known:
    """Row 3: J2 from the held knee and J1 from the hip, while the hip swings (eqs. (14)-(16)).

    Friction is not known yet and taken as zero.

    Args:
        model: Of :func:`document_model`.
        known: With the mass moments and the knee's stiffness.
        recording: Of the swinging hip.
        preparation: The document's exponential moving average unless given.

    Raises:
        ExoidError: The recording has no torque, or is too short.
    """
    preparation = preparation or MovingAverage()
    known = known.fit(rows_in_motion(model, [recording], KNEE, preparation), ["J2"])
    return known.fit(rows_in_motion(model, [recording], HIP, preparation), ["J1"])


def damping(
    model: TorqueModel, known: Known, recording: Recording, joint: int, preparation: Preparation | None = None
) -> Known:
    """Rows 4 and 5: Coulomb, viscous and constant part of a joint's friction while it swings alone.

    Args:
        model: Of :func:`document_model`.
        known: With everything but this friction; a constant b0 known already is not found again.
        recording: Of the swinging joint, another than row 3's: the same noise twice would not be the same uncertainty.
        joint: HIP or KNEE.
        preparation: The document's exponential moving average unless given.

    Raises:
        ExoidError: The recording has no torque, or is too short.
    """
    label = model.leg.joint_labels[joint]
    names = [f"c0_{label}", f"d_{label}"]
    if f"b0_{label}" not in known.names:
        names.append(f"b0_{label}")
    return known.fit(rows_in_motion(model, [recording], joint, preparation or MovingAverage()), names)
