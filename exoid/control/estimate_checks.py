"""Models that no law should compensate."""

from __future__ import annotations

import warnings

from .model import ControlModel

SPEED = 1.0
"""Up to which friction must resist [rad/s]: a slightly negative viscous one beside Coulomb friction is only noise."""


def warn_of_active_friction(model: ControlModel) -> None:
    """Warn where friction is negative, as in doc. 2, Table III as printed: under its eq. (6) it would inject energy.

    A law that compensates it pushes against the motion that it should help.
    """
    wrong = [
        f"{label}: {c0:.4g} sgn(v) {d:+.4g} v N·m"
        for label, c0, d in zip(model.leg.joint_labels, model.coulomb, model.viscous, strict=True)
        if min(c0, c0 + SPEED * d) < 0.0
    ]
    if wrong:
        warnings.warn(
            f"friction that drives the joint ({'; '.join(wrong)}): a law that compensates it brakes where it should "
            "help. Check the sign convention; doc. 2 prints its Table III with this sign",
            UserWarning,
            stacklevel=3,
        )
