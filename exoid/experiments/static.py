"""Static experiments: approach a pose from below and from above, wait, read the torque (doc. 1, sec. III-B1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.torso import TorsoMotion
from exoid.rig import Plant, Run, simulate
from exoid.signals import Approaches, Poses
from exoid.tools.numbers import checked
from exoid.torques.catalog import radians
from exoid.torques.position_units import position_units

from .bench import Bench
from .limits import refuse_poses_beyond_limits
from .references import Approach


@dataclass(frozen=True)
class StaticProtocol:
    """Approach of a pose and reading of its torque.

    Attributes:
        distance: Distance of the start below or above the pose, at each joint [rad]; a tenth of it in m of a slide.
        travel: Time of travel to the pose [s].
        wait: Settling time at the pose [s].
        readings: Number of final samples that are averaged.

    Raises:
        ExoidError: A number is not positive.
    """

    distance: float = np.deg2rad(8.0)
    travel: float = 2.0
    wait: float = 2.0
    readings: int = 10

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name in ("distance", "travel", "wait"):
            checked(getattr(self, name), name, above=0.0)
        checked(self.readings, "readings", least=1)


def run_static(
    plant: Plant, poses: FloatArray, bench: Bench, rng: np.random.Generator, protocol: StaticProtocol | None = None
) -> list[Approaches]:
    """Measure poses on B virtual rigs, approached from below and from above.

    Args:
        plant: B rigs.
        poses: Angles of all rigs [rad], (K, n).
        bench: Controller, actuator, sensors and rates.
        rng: Generator of the sensor noise.
        protocol: Approach and readings; None for the default.

    Returns:
        K poses from below and from above, for each rig.

    Raises:
        ExoidError: A pose is beyond the limits of a joint, the approach exceeds the speed limit of a joint, or the
            readings begin during the travel; or, after the run, a joint did not come to rest.
    """
    protocol = protocol or StaticProtocol()
    refuse_poses_beyond_limits(plant.leg, poses)
    _refuse_fast_approach(plant, protocol, bench)
    count = len(poses)
    wide = plant.repeat(2 * count)  # rig by rig: K poses from below, K from above
    goal = np.tile(np.concatenate([poses, poses]), (plant.count, 1)).T
    side = np.outer(protocol.distance * radians(plant.leg), np.tile(np.repeat([-1.0, 1.0], count), plant.count))
    start = np.clip(goal + side, wide.lower, wide.upper)
    duration = protocol.travel + protocol.wait
    run = simulate(
        wide,
        Approach(start, goal, protocol.travel),
        bench.controller,
        bench.actuator,
        duration,
        start=start,
        sensors=bench.sensors,
        rates=bench.rates,
        seed=rng,
    )
    moved = np.ptp(run.q[-protocol.readings :], axis=0).max(axis=0)
    unsettled = np.flatnonzero(moved > 1e-4)  # rad
    if len(unsettled):
        worst = int(moved.argmax())
        raise BadArgumentError(
            f"{len(unsettled)} of {len(moved)} poses did not come to rest: rig {worst} moved by {moved[worst]:.2g} rad "
            "during the readings",
            remedy="wait longer, or add damping to the servo",
        )
    return [
        Approaches(*(_read(run, slice(first, first + count), protocol.readings) for first in (a, a + count)))
        for a in range(0, wide.count, 2 * count)
    ]


def _refuse_fast_approach(plant: Plant, protocol: StaticProtocol, bench: Bench) -> None:
    """Refuse an approach that is too fast, and readings that begin during the travel."""
    # the largest speed of an `Approach` is 15/8 of its mean speed
    fastest = 1.875 * protocol.distance * radians(plant.leg) / protocol.travel
    slow = plant.leg.limits.velocity < fastest
    if slow.any():
        joint = int(slow.argmax())
        asked, limit = map(position_units(plant.leg)[joint].show, (fastest[joint], plant.leg.limits.velocity[joint]))
        raise BadArgumentError(
            f"the approach asks {plant.leg.joint_names[joint]} for {asked}/s, its limit is {limit}/s",
            remedy="increase the time of travel, or start closer",
        )
    if protocol.readings > protocol.wait * bench.rates.log:
        raise BadArgumentError(
            f"{protocol.readings} readings at {bench.rates.log:g} Hz take longer than the wait of {protocol.wait:g} s",
            remedy="wait longer, or read fewer",
        )


def _read(run: Run, rigs: slice, readings: int) -> Poses:
    q = run.q_measured[-readings:, :, rigs].mean(axis=0).T
    tau = run.tau_measured[-readings:, :, rigs].mean(axis=0).T
    pitch = float(run.plant.pitch[rigs][0])
    return Poses(q, tau, run.plant.leg.joint_names, TorsoMotion(pitch=pitch) if pitch else None)
