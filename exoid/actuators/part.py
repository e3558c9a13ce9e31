"""Part of the actuators of a leg: the drive of one joint or a coupling of several, seen alike."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.signals import Recording, smooth_motion

from .coupling import Coupling
from .drive import Drive
from .motor import Motor

DIRECTION_CUTOFF = 8.0
"""Cut-off of velocity and current that tell the direction of power [Hz],"""

DIRECTION_SHARE = 0.2
"""or this share of the sampling rate where that is less."""

DRIVE_CHANNELS = ("current", "force", "motor_torque", "motor_angle")
"""Quantities of a recording that drives measure."""


class Part(NamedTuple):
    """Drive of one joint, or coupling of several, seen alike."""

    name: str  # name of the joint or coupling
    joints: tuple[str, ...]  # joints that it drives, (k,)
    drive: Drive | Coupling  # drive or coupling

    @property
    def channel(self) -> str:
        """Quantity that it needs."""
        return self.drive.channel

    def is_wanted(self, recording: Recording, columns: Mapping[str, int]) -> bool:
        """Say whether the recording has its joints, and lacks the torque of one of them."""
        places = [columns[joint] for joint in self.joints if joint in columns]
        return len(places) == len(self.joints) and not recording.measured[places].all()

    def readings(self, recording: Recording, columns: Mapping[str, int]) -> FloatArray | None:
        """Readings of all its joints, (N, k); None if some were not recorded."""
        values = getattr(recording, self.channel)
        if values is None:
            return None
        own = values[:, [columns[joint] for joint in self.joints]]
        return None if np.isnan(own).all(axis=0).any() else own

    @property
    def needs_temperature(self) -> bool:
        """Whether its torque depends on temperature."""
        return isinstance(self.drive, Motor) and self.drive.temperature_coefficient is not None

    def temperature_factor(self, recording: Recording, columns: Mapping[str, int]) -> FloatArray:
        """Torque over that at the reference temperature, (N, k)."""
        if not isinstance(self.drive, Motor) or self.drive.temperature_coefficient is None:
            return np.ones((len(recording), len(self.joints)))
        place = columns[self.joints[0]]
        if recording.temperature is None or np.isnan(recording.temperature[:, place]).any():
            name = recording.joint_names[place]
            raise ExoidError(
                f"the motor has a temperature_coefficient, and the recording has no temperature of {name}",
                remedy=f"record it in a column temp_{name} [°C], or take the torque constant of one temperature: "
                "motor.at_temperature(40.0)",
                command=f"record it in a column temp_{name} [°C], map it (--column temp_{name}=HEADER), or leave "
                "temperature_coefficient out",
            )
        return self.drive.temperature_factor(recording.temperature[:, [place]])

    def torque(self, reading: FloatArray, q: FloatArray, v: FloatArray, rate: float | None = None) -> FloatArray:
        """Torques of its joints [N·m], (N, k), from readings at a sampling rate [Hz]; None without noise."""
        # Noise around zero would change the direction of power from sample to sample, and pass for a lower efficiency.
        # The sign of a motor's current is therefore that of its low-passed current.
        if isinstance(self.drive, Coupling):
            return self.drive.torque(reading, q, v)
        if isinstance(self.drive, Motor) and self.drive.needs_velocity and rate is not None:
            direction = smooth_motion(reading, rate, min(DIRECTION_CUTOFF, DIRECTION_SHARE * rate))
            return self.drive.torque(reading[:, 0], q[:, 0], v[:, 0], direction[:, 0])[:, None]
        return self.drive.torque(reading[:, 0], q[:, 0], v[:, 0])[:, None]

    def command(self, torque: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """Commands that make torques, (N, k)."""
        if isinstance(self.drive, Coupling):
            return self.drive.command(torque, q, v)
        return self.drive.command(torque[:, 0], q[:, 0], v[:, 0])[:, None]
