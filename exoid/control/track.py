"""Every law on the leg that an estimate describes: as it is, or with friction and loads that the laws do not know."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from exoid._typing import ArrayLike
from exoid.errors import ExoidError
from exoid.rig import Payload, Plant, Reference, Sensors, load_plant

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
    rate: float = RATE,
    friction: float = 1.0,
    payloads: Sequence[Payload] = (),
    sensors: Sensors | None = SENSORS,
    seed: int = 0,
    progress: Callable[[float], None] | None = None,
) -> dict[str, Tracking]:
    """Let the standard laws follow a periodic reference on a rig made of what is known of the leg.

    Args:
        source: What is known: the rig is made of it, and the laws know it.
        kp: Kp [N·m/rad], a number or one for each joint.
        kd: Kd [N·m·s/rad].
        reference: Of one leg.
        period: [s].
        periods: How many are followed; the first is not counted in the metrics.
        rate: Of all laws [Hz].
        friction: Of the rig, in multiples of that which the laws know.
        payloads: On the rig, which the laws do not know of.
        sensors: Of the rig; None for exact ones.
        seed: Of the sensor noise.
        progress: Told the share that is done.

    Returns:
        What each law did, see :func:`exoid.control.standard_laws`.

    Raises:
        ExoidError: The reference leaves the joints' limits, there are less than two periods, or a run diverges.

    Example:
        >>> runs = track(est, 22.0, 2.2, healthy_gait(), 10.0, friction=1.5)  # doctest: +SKIP
    """
    if periods < 2 or not 0.0 <= friction < np.inf:
        raise ExoidError(
            f"{periods} periods, {friction:g} times the friction", remedy="follow two at least, with friction ≥ 0"
        )
    model = ControlModel.of(source)
    plant = source if isinstance(source, Plant) else model.plant()
    plant = replace(
        plant, coulomb=friction * plant.coulomb, static=friction * plant.static, viscous=friction * plant.viscous
    )
    return compare_laws(
        load_plant(plant, payloads),
        standard_laws(model, kp, kd, reference, period, rate=rate),
        reference,
        periods * period,
        sensors=sensors,
        settle=period,
        seed=seed,
        progress=progress,
    )
