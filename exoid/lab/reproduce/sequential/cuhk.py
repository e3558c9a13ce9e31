"""Document 2's identification of a two-segment leg, one function for each row of its Table II.

Every step extends the estimate that it receives. The sign of the document's equations is that of exoid: dissipative
friction is positive (its Table III prints the opposite).
"""

from __future__ import annotations

import numpy as np

from exoid.leg.leg import Leg
from exoid.signals import MovingAverage, Poses, Preparation, Recording
from exoid.torques import Coulomb, Stiffness, TorqueModel, Viscous

from .estimate import SequentialEstimate, planar_model, rows_at_rest, rows_in_motion

HIP, KNEE = 0, 1


def document_model(leg: Leg) -> TorqueModel:
    """Make the model with stiffness, Coulomb and viscous friction (doc. 2, eq. (6), Table III)."""
    return planar_model(leg, ("hip", "knee"), 2, (Stiffness(degree=1), Coulomb(smoothing=0.0), Viscous()))


def knee_stiffness(model: TorqueModel, known: SequentialEstimate, poses: Poses) -> SequentialEstimate:
    """Row 1: identify b1 of the knee from poses of equal gravity torque (doc. 2, eq. (21))."""
    # The stiffness of the hip cannot be identified in this way, as its gravity torque changes with θh (doc. 2,
    # eq. (20)). The document sets it to zero.
    rows = rows_at_rest(model, poses, KNEE)
    name = f"b1_{model.leg.joint_labels[KNEE]}"
    own = rows._replace(columns={name: rows.columns[name]})
    return known.fit(own, [name], nuisance=np.ones((len(rows.tau), 1)))


def mass_moments(model: TorqueModel, known: SequentialEstimate, poses: Poses) -> SequentialEstimate:
    """Row 2: X2, Y2 and b0 from the knee torque, then X1 and Y1 from the hip's (doc. 2, eqs. (20)-(21))."""
    label = model.leg.joint_labels[KNEE]
    known = known.fit(rows_at_rest(model, poses, KNEE), ["X2", "Y2", f"b0_{label}"])
    return known.fit(rows_at_rest(model, poses, HIP), ["X1", "Y1"])


def inertias(
    model: TorqueModel, known: SequentialEstimate, recording: Recording, preparation: Preparation | None = None
) -> SequentialEstimate:
    """Row 3: identify J2 from the held knee and J1 from the hip while the hip swings (doc. 2, eqs. (14)-(16))."""
    # Friction is unknown at this step and taken as zero.
    preparation = preparation or MovingAverage()
    known = known.fit(rows_in_motion(model, [recording], KNEE, preparation), ["J2"])
    return known.fit(rows_in_motion(model, [recording], HIP, preparation), ["J1"])


def damping(
    model: TorqueModel,
    known: SequentialEstimate,
    recording: Recording,
    joint: int,
    preparation: Preparation | None = None,
) -> SequentialEstimate:
    """Rows 4 and 5: friction and constant torque of a joint while it swings alone."""
    label = model.leg.joint_labels[joint]
    names = [f"c0_{label}", f"d_{label}"]
    if f"b0_{label}" not in known.names:
        names.append(f"b0_{label}")
    return known.fit(rows_in_motion(model, [recording], joint, preparation or MovingAverage()), names)
