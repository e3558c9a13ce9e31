"""Terms of the motors of a coupling: friction and rotors in front of it."""

from __future__ import annotations

import numpy as np

from exoid.torques import DEFAULT_TERMS, Coulomb, CouplingFriction, CouplingInertia, Term

from .coupling import Coupling

NEGLIGIBLE = 1e-12
"""An entry of A⁻¹ below this part of the largest is zero."""


def motor_terms(coupling: Coupling) -> tuple[Term, ...]:
    """Make terms of the motors of a coupling: Coulomb and viscous friction, and rotors.

    Motor k has the angle θ_k = Σ_j (A⁻¹)_kj q_j. Velocities of its Coulomb friction are those of the default terms,
    times :attr:`Coupling.ratio`. A motor that moves one joint alone has none: its friction and rotor are terms of that
    joint.

    Args:
        coupling: The coupling.

    Returns:
        The terms.

    Example:
        >>> from exoid.torques import TorqueModel
        >>> wrist = Coupling(("hip", "knee"), ((0.5, 0.5), (0.5, -0.5)))
        >>> TorqueModel(exoid.load_leg("cuhk"), motor_terms(wrist)).names[6:]
        ('c0_hip_motor', 'd_hip_motor', 'c0_knee_motor', 'd_knee_motor', 'Ia_hip_motor')
    """
    (coulomb,) = (term for term in DEFAULT_TERMS if isinstance(term, Coulomb))
    smoothing, reversal_speed = (
        coupling.ratio * float(each)  # type: ignore[arg-type]  # the default terms have numbers
        for each in (coulomb.smoothing, coulomb.reversal_speed)
    )
    frictions: list[Term] = []
    rotors: list[Term] = []
    for motor, row in zip(coupling.joints, coupling.inverse, strict=True):
        moved = np.flatnonzero(np.abs(row) > NEGLIGIBLE * np.abs(row).max()).tolist()
        if len(moved) < 2:
            continue
        joints, ratios = tuple(coupling.joints[j] for j in moved), tuple(row[moved].tolist())
        name = f"{motor}_motor"
        frictions.append(
            CouplingFriction(
                joints=joints, ratios=ratios, name=name, smoothing=smoothing, reversal_speed=reversal_speed
            )
        )
        rotors.append(CouplingInertia(joints=joints, ratios=ratios, name=name))
    return (*frictions, *rotors)
