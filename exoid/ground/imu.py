"""Bias and misalignment of an inertial measurement unit, found while a foot rests on the ground."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.leg import Leg
from exoid.signals import BaseMotion, Recording

from .standing_base import standing_base

LEAST = 2.0
"""Shortest rest from which a bias is estimated [s]."""

SURE = 3.0
"""A misalignment is kept apart from a bias where it is larger than so many of its standard deviations."""


class ImuErrors(NamedTuple):
    """Errors of an inertial measurement unit on the base, in the axes of the base.

    Attributes:
        gyro_bias: Offset of the angular velocity [rad/s], (3,).
        force_bias: Offset of the specific force [m/s²], (3,).
        rotation: Small rotation of the readings [rad], (3,); zero where the motion does not tell it from a bias.
        std: Standard deviations of the nine numbers above, in their order, (9,).
    """

    gyro_bias: FloatArray
    force_bias: FloatArray
    rotation: FloatArray
    std: FloatArray

    def corrected(self, base: BaseMotion) -> BaseMotion:
        """Take the errors out of readings.

        Args:
            base: Readings.

        Returns:
            Readings without the errors.
        """
        gyro, force = base.angular_velocity - self.gyro_bias, base.specific_force - self.force_bias
        return BaseMotion(gyro - np.cross(self.rotation, gyro), force - np.cross(self.rotation, force), base.position)


def imu_errors(leg: Leg, recording: Recording, link: str, resting: NDArray[np.bool_]) -> ImuErrors | None:
    """Compare an inertial measurement unit with the motion that joint angles say while a link rests on the ground.

    Readings are ω' = ω + δ × ω + b_ω and f' = f + δ × f + b_f with biases b and a small rotation δ. They are linear in
    the nine unknowns, which least squares finds.

    Args:
        leg: The leg.
        recording: Recording with the readings, at even time stamps.
        link: Link that rests flat on level ground.
        resting: Samples at which it does, (N,).

    Returns:
        The errors; None if the base was not measured by such a unit, or the rest is too short.
    """
    base = recording.base
    if base is None or base.pose is not None or np.count_nonzero(resting) < LEAST * recording.sample_rate:
        return None
    true = standing_base(leg, recording, link)
    omega = true.angular_velocity
    alpha = np.gradient(omega, recording.time, axis=0)
    at_sensor = true.specific_force + np.cross(alpha, base.position) + np.cross(omega, np.cross(omega, base.position))
    aside = (base.angular_velocity - omega)[resting], (base.specific_force - at_sensor)[resting]
    return _fit(omega[resting], at_sensor[resting], *aside)


def _fit(omega: FloatArray, force: FloatArray, of_gyro: FloatArray, of_force: FloatArray) -> ImuErrors:
    """Fit biases and rotation to differences of angular velocity and specific force, (N, 3) each."""
    biases = np.concatenate([of_gyro.mean(axis=0), of_force.mean(axis=0)])
    noise = np.array([of_gyro.std(), of_force.std()])
    # what the biases leave: δ × (ω − mean), δ × (f − mean)
    rows = np.vstack([_crossed(omega) / max(noise[0], TINY), _crossed(force) / max(noise[1], TINY)])
    left = np.concatenate(
        [
            (of_gyro - biases[:3]).ravel() / max(noise[0], TINY),
            (of_force - biases[3:]).ravel() / max(noise[1], TINY),
        ]
    )
    information = rows.T @ rows + TINY * np.eye(3)
    covariance = np.linalg.pinv(information, rcond=1e-9, hermitian=True)
    rotation = covariance @ (rows.T @ left)
    spread = np.sqrt(np.diag(covariance))
    if not (np.abs(rotation) > SURE * spread).any():
        rotation = np.zeros(3)
    else:
        biases -= np.concatenate([np.cross(rotation, omega.mean(axis=0)), np.cross(rotation, force.mean(axis=0))])
    std = np.concatenate([np.repeat(noise / np.sqrt(len(omega)), 3), spread])
    return ImuErrors(biases[:3], biases[3:], rotation, std)


TINY = 1e-12
"""Stands for noise that is not there."""


def _crossed(vectors: FloatArray) -> FloatArray:
    """Rows of δ × (u − mean u) as a linear function of δ, (3 N, 3)."""
    x, y, z = (vectors - vectors.mean(axis=0)).T
    zero = np.zeros_like(x)
    return np.stack(
        [np.stack([zero, z, -y], -1), np.stack([-z, zero, x], -1), np.stack([y, -x, zero], -1)], axis=1
    ).reshape(-1, 3)
