"""Models that no law should compensate."""

from __future__ import annotations

import warnings

from .friction import FrictionCompensation
from .model import ControlModel, ModelSource

SPEED = 1.0
"""Up to which friction must resist [rad/s]: a slightly negative viscous one beside Coulomb friction is only noise."""


def model_to_compensate(source: ModelSource, friction: FrictionCompensation | None) -> ControlModel:
    """Take over the model that a law compensates.

    Args:
        source: An estimate, a leg, or a plant of one rig.
        friction: How friction is compensated; None for not at all.

    Returns:
        The model.

    Raises:
        ExoidError: There is no model to be had from the source.

    Warns:
        UserWarning: Friction is compensated and negative, as in doc. 2, Table III as printed. Under its eq. (6) it
            would inject energy: the law would push against the motion that it should help.
    """
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
            f"friction that drives the joint ({'; '.join(wrong)}): a law that compensates it brakes where it should "
            "help. Check the sign convention; doc. 2 prints its Table III with this sign",
            UserWarning,
            stacklevel=3,
        )
    return model
