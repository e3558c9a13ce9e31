"""Dynamic experiments: a rig follows a motion and logs it (doc. 1, sec. III-B2; doc. 2, sec. III)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from exoid.rig import Plant, Reference, Run, simulate

from .bench import Bench
from .limits import refuse_motion_beyond_limits


def run_motion(
    plant: Plant,
    motion: Reference,
    bench: Bench,
    duration: float,
    rng: np.random.Generator,
    progress: Callable[[float], None] | None = None,
) -> Run:
    """Let B virtual rigs follow a motion within the limits of the leg."""
    refuse_motion_beyond_limits(plant.leg, motion, duration)
    return simulate(
        plant,
        motion,
        bench.controller,
        bench.actuator,
        duration,
        sensors=bench.sensors,
        rates=bench.rates,
        seed=rng,
        progress=progress,
    )
