"""Test bench: controller, actuator, sensors and rates of a rig, and a motion on it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from exoid.rig import Actuator, Controller, Plant, ProportionalDerivative, Rates, Reference, Run, Sensors, simulate

from .limits import refuse_motion_beyond_limits


@dataclass(frozen=True)
class Bench:
    """Controller, actuator, sensors and rates of an experiment.

    Attributes:
        controller: Controller of the joints.
        actuator: Actuator of each joint.
        sensors: Sensors of each joint.
        rates: Rates of controller and log, and step of the plant.
    """

    controller: Controller
    actuator: Actuator
    sensors: Sensors
    rates: Rates


def stiff_servo(plant: Plant) -> ProportionalDerivative:
    """Choose gains Kp = ω² I and Kd = 2 ω I with ω = 100 rad/s, for a controller of at least 500 Hz."""
    # I is the inertia at a joint while the others move freely, 1/(M⁻¹)_ii, at its minimum over poses within the limits.
    leg = plant.leg.with_parameters(plant.parameters[:, 0])
    lower, upper = (np.clip(limit, -np.pi, np.pi) for limit in (leg.limits.lower, leg.limits.upper))
    poses = np.random.default_rng(0).uniform(lower, upper, (50, plant.n))
    M = leg.mass_matrix(poses) + np.diag(plant.armature[:, 0])
    inertia = 1.0 / np.diagonal(np.linalg.inv(M), axis1=1, axis2=2).max(axis=0)
    return ProportionalDerivative(100.0**2 * inertia, 2.0 * 100.0 * inertia)


def run_motion(
    plant: Plant,
    motion: Reference,
    bench: Bench,
    duration: float,
    rng: np.random.Generator,
    progress: Callable[[float], None] | None = None,
) -> Run:
    """Let B virtual rigs follow a motion within the limits of the leg (doc. 1, sec. III-B2; doc. 2, sec. III)."""
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
