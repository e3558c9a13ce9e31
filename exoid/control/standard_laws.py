"""Controllers of this package at one set of gains and one rate, ready to be compared."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from exoid._typing import ArrayLike
from exoid.errors import BadArgumentError
from exoid.rig import Reference

from .adaptive import adaptive
from .law import RATE
from .laws import computed_torque, feedforward_pd, gravity_friction_pd, pd
from .lqr import lqr
from .mean_pose import mean_pose
from .model import ControlModel, ModelSource
from .self_tuning import self_tuning
from .stateful import AnyLaw

LAWS = ("pd", "pd_gravity_friction", "pd_feedforward", "computed_torque", "lqr", "adaptive", "self_tuning")
"""Names of the standard controllers."""


def standard_laws(
    source: ModelSource,
    kp: ArrayLike,
    kd: ArrayLike,
    reference: Reference,
    period: float,
    *,
    rate: float = RATE,
    names: Sequence[str] = LAWS,
) -> dict[str, AnyLaw]:
    """Make PD, PD with gravity and friction, PD with feedforward, computed torque, LQR, and two adaptive controllers.

    Computed torque has the same stiffness as the others: Kp and Kd divided by the diagonal of the mass matrix at the
    mean pose of the reference. The gain of LQR follows from :class:`exoid.control.Weights`. The covariance of
    an estimate is part of the metric of adaptive control, and of the prior of self-tuning control.

    Args:
        source: Source of the controllers' model.
        kp: Kp [N·m/rad], a number or one for each joint.
        kd: Kd [N·m·s/rad].
        reference: Periodic reference of one leg.
        period: Period of the reference [s].
        rate: Sampling rate of all controllers [Hz].
        names: Names out of :data:`LAWS`.

    Returns:
        Controllers by name, in the order of ``names``.

    Raises:
        ExoidError: A name is unknown, or gains, rate or period are invalid.
    """
    model = ControlModel.of(source)
    inertia = np.diagonal(model.mass_matrix(mean_pose(reference, period)))
    soft = [np.asarray(gain, dtype=np.float64) / inertia for gain in (kp, kd)]
    makers: dict[str, Callable[[], AnyLaw]] = {
        "pd": lambda: pd(kp, kd, rate=rate),
        "pd_gravity_friction": lambda: gravity_friction_pd(model, kp, kd, rate=rate),
        "pd_feedforward": lambda: feedforward_pd(model, kp, kd, rate=rate),
        "computed_torque": lambda: computed_torque(model, *soft, rate=rate),
        "lqr": lambda: lqr(model, reference, period, rate=rate),
        "adaptive": lambda: adaptive(source, kp, kd, rate=rate),
        "self_tuning": lambda: self_tuning(source, kp, kd, rate=rate),
    }
    refuse_unknown_laws(names)
    return {name: makers[name]() for name in names}


def refuse_unknown_laws(names: Sequence[str]) -> None:
    """Refuse names that are not in :data:`LAWS`."""
    unknown = [name for name in names if name not in LAWS]
    if unknown or not names:
        raise BadArgumentError(
            f"no controller {', '.join(unknown) or 'at all'}", remedy=f"use some of {', '.join(LAWS)}"
        )
