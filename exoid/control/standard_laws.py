"""The laws of this room at one set of gains and one rate, ready to be compared."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError
from exoid.rig import Reference

from .computed_torque import computed_torque
from .feedforward_pd import feedforward_pd
from .gravity_friction_pd import gravity_friction_pd
from .law import RATE, Law
from .lqr import lqr
from .mean_pose import mean_pose
from .model import ControlModel, ModelSource
from .pd import pd

LAWS = ("pd", "pd_gravity_friction", "pd_feedforward", "computed_torque", "lqr")
"""Names of the laws."""

BANDWIDTH = 5.0
"""Natural frequency of the default gains [rad/s], as soft as those that document 2's errors suggest."""

DAMPING = 0.1
"""Kd over Kp [s]."""


def standard_laws(
    source: ModelSource,
    kp: ArrayLike,
    kd: ArrayLike,
    reference: Reference,
    period: float,
    *,
    rate: float = RATE,
    names: Sequence[str] = LAWS,
) -> dict[str, Law]:
    """Make PD, PD with gravity and friction, PD with feed-forward, computed torque, and LQR along the reference.

    Computed torque gets the same stiffness as the others: Kp and Kd over the diagonal of the mass matrix at the mean
    pose of the reference. LQR has gains of its own, by :class:`exoid.control.Weights`.

    Args:
        source: What the laws know of the leg.
        kp: Kp [N·m/rad], a number or one for each joint.
        kd: Kd [N·m·s/rad].
        reference: Of one leg, periodic.
        period: [s].
        rate: Of all laws [Hz].
        names: Of :data:`LAWS`, which ones.

    Returns:
        Laws by name, in the order of ``names``.

    Raises:
        ExoidError: There is no such law, or gains, rate or period make no sense.
    """
    model = ControlModel.of(source)
    inertia = np.diagonal(model.mass_matrix(mean_pose(reference, period)))
    soft = [np.asarray(gain, dtype=np.float64) / inertia for gain in (kp, kd)]
    makers: dict[str, Callable[[], Law]] = {
        "pd": lambda: pd(kp, kd, rate=rate),
        "pd_gravity_friction": lambda: gravity_friction_pd(model, kp, kd, rate=rate),
        "pd_feedforward": lambda: feedforward_pd(model, kp, kd, rate=rate),
        "computed_torque": lambda: computed_torque(model, *soft, rate=rate),
        "lqr": lambda: lqr(model, reference, period, rate=rate),
    }
    refuse_unknown_laws(names)
    return {name: makers[name]() for name in names}


def refuse_unknown_laws(names: Sequence[str]) -> None:
    """Refuse names that are not of :data:`LAWS`.

    Raises:
        ExoidError: Says which are.
    """
    unknown = [name for name in names if name not in LAWS]
    if unknown or not names:
        raise ExoidError(f"no law {', '.join(unknown) or 'at all'}", remedy=f"use some of {', '.join(LAWS)}")


def default_gains(source: ModelSource, pose: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Kp = ω² M_ii and Kd = 0.1 s · Kp for a natural frequency ω of 5 rad/s at a pose.

    Args:
        source: What is known of the leg.
        pose: [rad], (n,).

    Returns:
        Kp [N·m/rad] and Kd [N·m·s/rad], (n,) each.
    """
    kp = BANDWIDTH**2 * np.diagonal(ControlModel.of(source).mass_matrix(pose))
    return kp, DAMPING * kp
