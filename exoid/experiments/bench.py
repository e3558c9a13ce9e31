"""Everything of a rig but its legs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid.rig import Actuator, Controller, Plant, ProportionalDerivative, Rates, Sensors

STIFF = 100.0
"""Bandwidth of a stiff servo [rad/s]."""

POSES = 50
"""At which it is looked how heavy a leg feels."""


@dataclass(frozen=True)
class Bench:
    """How rigs are driven, measured and timed.

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


def stiff_servo(plant: Plant) -> ProportionalDerivative:
    """Kp = ω² I and Kd = 2 ω I with ω = 100 rad/s: stiff, as for exercises on a jig; to be sampled at 500 Hz or more.

    I is the least inertia that a joint feels when the others are free, 1/(M⁻¹)_ii, over poses within the limits.

    Args:
        plant: Of whose first rig the bodies and rotors are.
    """
    leg = plant.leg.with_parameters(plant.parameters[:, 0])
    lower, upper = (np.clip(limit, -np.pi, np.pi) for limit in (leg.limits.lower, leg.limits.upper))
    poses = np.random.default_rng(0).uniform(lower, upper, (POSES, plant.n))
    M = leg.mass_matrix(poses) + np.diag(plant.armature[:, 0])
    inertia = 1.0 / np.diagonal(np.linalg.inv(M), axis1=1, axis2=2).max(axis=0)
    return ProportionalDerivative(STIFF**2 * inertia, 2.0 * STIFF * inertia)
