"""Warnings about models that no controller should compensate."""

from __future__ import annotations

import warnings

from .friction import FrictionCompensation
from .model import ControlModel, ModelSource

SPEED = 1.0
"""Velocity up to which friction must resist [rad/s]; slightly negative viscous friction beside Coulomb's is noise."""


def model_to_compensate(source: ModelSource, friction: FrictionCompensation | None) -> ControlModel:
    """Make the model that a controller compensates, and warn if its friction is negative."""
    # Warns:
    #     UserWarning: Friction is compensated and negative, as in doc. 2, Table III as printed. Under its eq. (6) it
    #         would inject energy: the compensation would oppose the motion that it should support.
    model = ControlModel.of(source)
    if friction is None:
        return model
    wrong = [
        f"{label}: {c0:.4g} sgn(v) {d:+.4g} v N·m"
        for label, c0, d in zip(model.leg.joint_labels, model.coulomb, model.viscous, strict=True)
        if min(c0, c0 + SPEED * d) < 0.0
    ]
    if wrong:
        warnings.warn(
            f"friction that drives the joint ({'; '.join(wrong)}): compensating it brakes the motion that it should "
            "support. Check the sign convention; doc. 2 prints its Table III with this sign",
            UserWarning,
            stacklevel=3,
        )
    return model
