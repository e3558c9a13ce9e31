"""Angles and torques of a leg at each frame of a scene."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.leg.leg import Leg
from exoid.leg.torso import TorsoMotion

from .replay import Replay


class LegTrajectory(NamedTuple):
    """Angles and torques of a leg, frame by frame."""

    q: FloatArray  # angles [rad], (F, n); one frame for a leg that stands still
    tau: FloatArray  # actuator torques [N·m], (F, n)
    measured: bool  # whether the torques were measured; otherwise they hold the leg against gravity
    pitch: float  # pitch of the torso [rad]

    @classmethod
    def of(cls, leg: Leg, q: FloatArray, replay: Replay | None) -> LegTrajectory:
        """Take the trajectory of a leg from a replay."""
        recorded = None if replay is None else replay.angles(leg)
        tau = None if replay is None else replay.torques(leg)
        angles = q[np.newaxis] if recorded is None else recorded
        pitch = 0.0 if replay is None else replay.pitch
        if tau is not None:
            return cls(angles, tau, True, pitch)
        holding = leg.gravity(angles, TorsoMotion(pitch) if pitch else None)[:, leg.base_rows :]
        return cls(angles, holding, False, pitch)
