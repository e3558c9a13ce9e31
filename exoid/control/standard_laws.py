"""Standard controllers at one set of gains and one rate, and all of them on the leg of an estimate."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError
from exoid.rig import Payload, Plant, Reference, Sensors, plant_with_payloads
from exoid.tools.numbers import checked

from .law import RATE, AnyLaw
from .laws import computed_torque, feedforward_pd, gravity_friction_pd, pd
from .lqr import lqr
from .model import ControlModel, ModelSource
from .self_tuning import self_tuning
from .side_by_side import compare_laws
from .tracking import Tracking

LAWS = ("pd", "gravity_friction_pd", "feedforward_pd", "computed_torque", "lqr", "self_tuning")
"""Names of the standard controllers."""


SENSORS = Sensors(encoder_counts=2.0**13, angle_noise=np.deg2rad(0.03), velocity_noise=0.01, torque_noise=0.3)
"""A potentiometer behind a 13-bit converter, a tachometer, a current sensor; assumed."""


INSTANTS = 64
"""Number of equally spaced instants of a period over which poses are averaged."""


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
    angles = np.array([reference.at(period * k / INSTANTS).q for k in range(INSTANTS)])
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
    inertia = np.diagonal(model.mass_matrix(pose))
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
        raise BadArgumentError(
            f"no controller {', '.join(unknown) or 'at all'}", remedy=f"use some of {', '.join(LAWS)}"
        )
    return {name: makers[name]() for name in names}


def track(
    source: ModelSource,
    kp: ArrayLike,
    kd: ArrayLike,
    reference: Reference,
    period: float,
    *,
    periods: int = 2,
    settle: float | None = None,
    rate: float = RATE,
    friction: float = 1.0,
    payloads: Sequence[Payload] = (),
    sensors: Sensors | None = SENSORS,
    seed: int = 0,
    progress: Callable[[float], None] | None = None,
) -> dict[str, Tracking]:
    """Let the standard controllers follow a reference on a rig built from their own model.

    Args:
        source: Source of the rig and of the controllers' model.
        kp: Kp [N·m/rad], a number or one for each joint.
        kd: Kd [N·m·s/rad].
        reference: Reference of one leg.
        period: Period of the reference, or the duration of one without a period [s].
        periods: Number of periods.
        settle: Time at the beginning that the metrics leave out [s]; None for the first period.
        rate: Sampling rate of all controllers [Hz].
        friction: Factor of the rig's friction relative to the controllers' model.
        payloads: Payloads of the rig, which the controllers' model lacks.
        sensors: Sensors of the rig; None for exact ones.
        seed: Seed of the sensor noise.
        progress: Function that receives the completed share, 0 to 1.

    Returns:
        Result of each controller by name; see :func:`exoid.control.standard_laws`.

    Raises:
        ExoidError: The reference leaves the joint limits, no time is left after it settles, or a run diverges.

    Example:
        >>> runs = track(est, 22.0, 2.2, healthy_gait(), 10.0, friction=1.5)  # doctest: +SKIP
    """
    if periods < 1 + (settle is None) or not 0.0 <= friction < np.inf:
        raise BadArgumentError(
            f"{periods} periods, {friction:g} times the friction",
            remedy="give two periods or more, with friction ≥ 0",
        )
    model = ControlModel.of(source)
    plant = source if isinstance(source, Plant) else model.plant()
    plant = replace(
        plant, coulomb=friction * plant.coulomb, static=friction * plant.static, viscous=friction * plant.viscous
    )
    return compare_laws(
        plant_with_payloads(plant, payloads),
        standard_laws(source, kp, kd, reference, period, rate=rate),
        reference,
        periods * period,
        sensors=sensors,
        settle=period if settle is None else settle,
        seed=seed,
        progress=progress,
    )
