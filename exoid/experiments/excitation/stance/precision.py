"""Predicted precision of recordings on the ground, whose forces are not measured."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from exoid.errors import ExoidError
from exoid.experiments.excitation.noise import TorqueNoise
from exoid.experiments.excitation.precision import Information, Precision, information_of
from exoid.experiments.excitation.scales import Scales
from exoid.regression.rows import for_leg
from exoid.signals import Preparation, Recording
from exoid.torques import TorqueModel
from exoid.torques.contacts import split
from exoid.torques.contacts.elimination import reference_axes
from exoid.torques.contacts.support_model import SupportModel

MANY = 2000
"""Samples that the reference of closed chains is chosen for."""


def predict_stance(
    model: TorqueModel,
    recordings: Iterable[Recording],
    noise: TorqueNoise,
    scales: Scales,
    preparation: Preparation | None = None,
) -> Precision:
    """Predict the covariance of weighted least squares from recordings whose links rest by unknown wrenches."""
    # Rows are those of `exoid.identify`: of each set of resting links those on which their wrenches do no work.
    # The noise of a row of a closed chain is Σ_j Z_j² σ_j², as its torque is Zᵀ τ. The motion of the base
    # counts as known, as from an IMU. Where feet carry it instead, the unknown compliance of their soles makes
    # intervals up to twice as wide.
    found: dict[tuple[str, ...], list[Recording]] = {}
    for recording in recordings:
        for links, part, *_ in split(model.leg, for_leg(model, recording)).stretches:
            found.setdefault(links, []).append(part)
    total: Information | None = None
    for links, parts in found.items():
        if not links:
            raise ExoidError(
                "the precision of measured wrenches is not predicted",
                remedy="leave the wrenches of the feet out: their noise is not known",
            )
        q = np.vstack([one.q[one.mask] for one in parts])
        support = SupportModel.of(model, links, reference_axes(model.leg, links, q[:: 1 + len(q) // MANY]))
        information = information_of(support, parts, noise, preparation)
        total = information if total is None else total.plus(information)
    if total is None:
        raise ExoidError("no recordings to predict the precision of", remedy="pass at least one")
    return total.precision(model, scales)
