"""Static experiments: go to a pose from below and from above, wait, read the torque (doc. 1, sec. III-B1)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.rig import Actuator, Controller, Plant, Rates, Run, Sensors, simulate
from exoid.signals import Approaches, Poses
from exoid.torso import TorsoMotion

from .limits import refuse_poses_beyond_limits
from .references import Approach

STILL = 1e-4
"""Slower than this [rad/s] counts as stopped."""


@dataclass(frozen=True)
class StaticProtocol:
    """How poses are reached and read.

    Attributes:
        distance: How far below or above the pose each joint starts [rad].
        travel: Time to get there [s].
        wait: Time to settle [s].
        readings: How many of the last samples are averaged.
    """

    distance: float = np.deg2rad(8.0)
    travel: float = 2.0
    wait: float = 2.0
    readings: int = 10


@dataclass(frozen=True)
class Bench:
    """Everything of a rig but the plant: how it is driven, measured and timed.

    Attributes:
        controller: Of the joints.
        actuator: Behind each command.
        sensors: In front of each log.
        rates: Of controller, log and plant.
    """

    controller: Controller
    actuator: Actuator
    sensors: Sensors
    rates: Rates


def run_static(
    plant: Plant,
    poses: FloatArray,
    bench: Bench,
    rng: np.random.Generator,
    protocol: StaticProtocol | None = None,
    progress: Callable[[float], None] | None = None,
) -> list[Approaches]:
    """Measure poses on B virtual rigs, all at once.

    Args:
        plant: B rigs.
        poses: Angles [rad], (K, n), for each rig alike.
        bench: Servo, sensors and rates.
        rng: Of the sensor noise.
        protocol: How poses are reached.
        progress: Told the share that is done.

    Returns:
        One set of K poses, from below and from above, for each rig.

    Raises:
        ExoidError: A pose is beyond the limits of a joint, or a joint does not come to rest.
    """
    protocol = protocol or StaticProtocol()
    refuse_poses_beyond_limits(plant.leg, poses)
    count = len(poses)
    wide = plant.each(2 * count)  # rig by rig: K poses from below, K from above
    goal = np.tile(np.concatenate([poses, poses]), (plant.count, 1)).T
    side = np.tile(np.repeat([-1.0, 1.0], count), plant.count) * protocol.distance
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
        progress=progress,
    )
    _refuse_restless(run)
    return [
        Approaches(*(_read(run, slice(first, first + count), protocol.readings) for first in (a, a + count)))
        for a in range(0, wide.count, 2 * count)
    ]


def _refuse_restless(run: Run) -> None:
    speed = np.abs(run.v[-1]).max(axis=0)
    if speed.max() > STILL:
        worst = int(speed.argmax())
        raise ExoidError(
            f"{np.mean(speed > STILL):.0%} of poses did not come to rest: rig {worst} goes at {speed[worst]:.2g} rad/s",
            remedy="wait longer, or damp the servo",
        )


def _read(run: Run, rigs: slice, readings: int) -> Poses:
    q = run.q_measured[-readings:, :, rigs].mean(axis=0).T
    tau = run.tau_measured[-readings:, :, rigs].mean(axis=0).T
    pitch = float(run.plant.pitch[rigs][0])
    return Poses(q, tau, run.plant.leg.joint_names, TorsoMotion(pitch=pitch) if pitch else None)
