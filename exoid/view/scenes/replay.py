"""A recording, sampled at the frames of an animation, and the motion of each leg in it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.leg import Leg
from exoid.leg.torso import TorsoMotion
from exoid.signals import Recording

from .commands import FRAMES_PER_SECOND


@dataclass(frozen=True, eq=False)
class Replay:
    """A recording at :data:`FRAMES_PER_SECOND`."""

    recording: Recording  # motion of the leg
    time: FloatArray  # time of each frame [s], (F,)

    @classmethod
    def of(cls, recording: Recording) -> Replay:
        """Choose the frames of a replay."""
        if recording.duration > 600.0:  # browsers struggle with larger pages
            raise BadArgumentError(
                f"a replay of {recording.duration:.0f} s; the longest is 600 s",
                remedy="choose a part: recording.between(start, stop), or --start and --stop",
            )
        frames = int(recording.duration * FRAMES_PER_SECOND) + 1
        return cls(recording, recording.time[0] + np.arange(frames) / FRAMES_PER_SECOND)

    @property
    def duration(self) -> float:
        """Time from the first frame to the last [s]."""
        return float(self.time[-1] - self.time[0])

    @property
    def pitch(self) -> float:
        """Pitch of the torso [rad]."""
        torso = self.recording.torso
        return 0.0 if torso is None else float(torso.samples(1).pitch[0])

    def angles(self, leg: Leg) -> FloatArray | None:
        """Angles of a leg's joints [rad], (F, n); None for a leg that was not recorded."""
        return self._at_frames(leg, "q")

    def torques(self, leg: Leg) -> FloatArray | None:
        """Recorded torques of a leg's joints [N·m], (F, n), or None."""
        found = None if self.recording.tau is None else self._at_frames(leg, "tau")
        return None if found is None else np.nan_to_num(found)  # no arrow where torque was not measured

    def _at_frames(self, leg: Leg, quantity: str) -> FloatArray | None:
        """Interpolate a quantity of a leg at the frames; None if the recording has none of its joints."""
        for names in (leg.joint_names, leg.joint_labels):
            if set(names) & set(self.recording.joint_names):
                return at_frames(self.time, self.recording.time, getattr(self.recording.select(names), quantity))
        return None


def at_frames(frames: FloatArray, time: FloatArray, values: FloatArray, gap: float = np.inf) -> FloatArray:
    """Interpolate values (N, k) at frames, (F, k); not a number further from any sample than a gap [s]."""
    after = np.clip(np.searchsorted(time, frames), min(1, len(time) - 1), len(time) - 1)
    distance = np.minimum(np.abs(time[after] - frames), np.abs(frames - time[after - 1]))
    columns = np.column_stack([np.interp(frames, time, column) for column in values.T])
    return np.where(distance[:, np.newaxis] < gap, columns, np.nan)


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
