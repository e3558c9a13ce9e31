"""Standard controllers at one set of gains and one rate."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError
from exoid.rig import Reference, Sensors
from exoid.tools.numbers import checked

from .law import RATE, AnyLaw
from .laws import computed_torque, feedforward_pd, gravity_friction_pd, pd
from .lqr import lqr
from .model import ControlModel, ModelSource, possible_mass_matrix
from .self_tuning import self_tuning

LAWS = ("pd", "gravity_friction_pd", "feedforward_pd", "computed_torque", "lqr", "self_tuning")
"""Names of the standard controllers."""

SENSORS = Sensors(encoder_counts=2.0**13, angle_noise=np.deg2rad(0.03), velocity_noise=0.01, torque_noise=0.3)
"""A potentiometer behind a 13-bit converter, a tachometer, a current sensor; assumed."""


def mean_pose(reference: Reference, period: float) -> FloatArray:
    """Average the angles of a reference over a period.

    Args:
        reference: Reference of one leg.
        period: Period of the reference, or its duration [s].

    Returns:
        Mean angles [rad], (n,).

    Raises:
        ExoidError: The period is not positive and finite, or the reference is that of several legs.
    """
    checked(period, "the period of the reference [s]", above=0.0)
    angles = np.array([reference.at(period * k / 64).q for k in range(64)])
    if angles.ndim != 3 or angles.shape[2] != 1:
        raise BadArgumentError(f"a reference of shape {angles.shape[1:]}", remedy="give that of one leg, (n, 1)")
    return np.asarray(angles[:, :, 0].mean(axis=0))


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
    """Make PD, PD with gravity and friction, PD with feedforward, computed torque, LQR, and self-tuning control.

    Computed torque has the same stiffness as the others: Kp and Kd divided by the diagonal of the mass matrix at the
    mean pose of the reference, where the gain of LQR is optimal too. The covariance of an estimate is part of the prior
    of self-tuning control.

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
    pose = mean_pose(reference, period)
    inertia = np.diagonal(possible_mass_matrix(model, pose))
    soft = [np.asarray(gain, dtype=np.float64) / inertia for gain in (kp, kd)]
    makers: dict[str, Callable[[], AnyLaw]] = {
        "pd": lambda: replace(pd(kp, kd, rate=rate), model=model),  # which names the joints in C
        "gravity_friction_pd": lambda: gravity_friction_pd(model, kp, kd, rate=rate),
        "feedforward_pd": lambda: feedforward_pd(model, kp, kd, rate=rate),
        "computed_torque": lambda: computed_torque(model, *soft, rate=rate),
        "lqr": lambda: lqr(model, pose, rate=rate),
        "self_tuning": lambda: self_tuning(source, kp, kd, rate=rate),
    }
    unknown = [name for name in names if name not in LAWS]
    if unknown or not names:
        what = f"no controller {', '.join(unknown) or 'at all'}"
        raise BadArgumentError(what, remedy=f"use some of {', '.join(LAWS)}")
    return {name: makers[name]() for name in names}
