"""All standard controllers on the leg of an estimate, also with friction and payloads that their model lacks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from exoid._typing import ArrayLike
from exoid.errors import BadArgumentError
from exoid.rig import Payload, Plant, Reference, Sensors, plant_with_payloads

from .compare_laws import compare_laws
from .law import RATE
from .model import ControlModel, ModelSource
from .standard_laws import standard_laws
from .tracking import Tracking

SENSORS = Sensors(encoder_counts=2.0**13, angle_noise=np.deg2rad(0.03), velocity_noise=0.01, torque_noise=0.3)
"""A potentiometer behind a 13-bit converter, a tachometer, a current sensor; assumed."""


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
