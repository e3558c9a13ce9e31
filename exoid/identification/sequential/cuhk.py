"""Document 2's identification of a two-segment leg, one function for each row of its Table II.

Every step takes what is known and returns what is known after it. Here the document's own sign is exoid's: dissipative
friction is positive (its Table III prints the opposite).
"""

from __future__ import annotations

from exoid.errors import ExoidError
from exoid.leg import Leg
from exoid.signals import MovingAverage, Poses, Preparation, Recording
from exoid.torques import Coulomb, Stiffness, TorqueModel, Viscous

from .known import Known
from .rows import dynamic_rows, static_rows

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
    """
    rows = static_rows(model, poses, KNEE)
    name = f"b1_{model.leg.joint_labels[KNEE]}"
    constant = rows.columns[f"b0_{model.leg.joint_labels[KNEE]}"][:, None]
    return known.fit({name: rows.columns[name]}, rows.tau, [name], constant)


def mass_moments(model: TorqueModel, known: Known, poses: Poses) -> Known:
    """Row 2: X2, Y2 and the knee's constant from the knee's torque, then X1 and Y1 from the hip's (eqs. (20)-(21))."""
    labels = model.leg.joint_labels
    knee = static_rows(model, poses, KNEE)
    known = known.fit(knee.columns, knee.tau, ["X2", "Y2", f"b0_{labels[KNEE]}"])
    hip = static_rows(model, poses, HIP)
    return known.fit(hip.columns, hip.tau, ["X1", "Y1"])


def inertias(model: TorqueModel, known: Known, recording: Recording, preparation: Preparation | None = None) -> Known:
    """Row 3: J2 from the held knee and J1 from the hip, while the hip swings (eqs. (14)-(16))."""
    preparation = preparation or MovingAverage()
    knee = dynamic_rows(model, [recording], KNEE, preparation)
    known = known.fit(knee.columns, knee.tau, ["J2"])
    hip = dynamic_rows(model, [recording], HIP, preparation)
    return known.fit(hip.columns, hip.tau, ["J1"])


def damping(
    model: TorqueModel, known: Known, recording: Recording, joint: int, preparation: Preparation | None = None
) -> Known:
    """Rows 4 and 5: Coulomb, viscous and constant part of a joint's friction while it swings alone."""
    rows = dynamic_rows(model, [recording], joint, preparation or MovingAverage())
    label = model.leg.joint_labels[joint]
    names = [f"c0_{label}", f"d_{label}"]
    if f"b0_{label}" not in known.names:
        names.append(f"b0_{label}")
    return known.fit(rows.columns, rows.tau, names)
