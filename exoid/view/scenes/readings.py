"""Numbers of joints and feet in a scene at each frame: angle and torque, centre of pressure and force."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate import Estimate, validate
from exoid.leg.leg import Leg

from .leg_geometry import LegGeometry
from .replay import LegTrajectory, Replay, at_frames


class Readings(NamedTuple):
    """Numbers of one joint or foot, frame by frame; one frame for a leg that stands still."""

    name: str  # name of the joint or link
    path: str  # path of its frame in the scene
    colour: str  # colour of the joint
    angle: FloatArray  # angle [deg] or displacement [mm] of a joint, centre of pressure forward of a foot [mm], (F,)
    torque: FloatArray  # recorded torque or vertical force, or torque that holds the leg against gravity, (F,)
    predicted: FloatArray | None  # the same as an estimate predicts it, (F,), not a number where not known; or None
    measured: bool  # whether it is plotted over time
    units: tuple[str, str]  # units of angle and torque
    foot: bool = False  # whether it is a foot

    def to_json(self) -> dict[str, Any]:
        """Describe the numbers as data for the page."""
        return {
            "name": self.name,
            "path": self.path,
            "colour": self.colour,
            "unit": self.units[0],
            "torque_unit": self.units[1],
            "angle": _numbers(self.angle),
            "torque": _numbers(self.torque),
            "predicted": None if self.predicted is None else _numbers(self.predicted),
            "measured": self.measured,
            "foot": self.foot,
        }


def joint_readings(
    source: Leg | Estimate, geometry: LegGeometry, q: FloatArray, replay: Replay | None
) -> Iterator[Readings]:
    """Read angle and torque of each joint of a leg."""
    trajectory = LegTrajectory.of(geometry.leg, q, replay)
    predicted = None
    if isinstance(source, Estimate) and replay is not None and trajectory.measured:
        try:
            found = validate(source, source.model.select(replay.recording).resampled())
        except ExoidError:  # the recording does not allow a prediction
            pass
        else:
            places = [found.joint_names.index(name) for name in geometry.leg.joint_names]
            predicted = at_frames(replay.time, found.time, found.predicted[:, places], gap=0.05)
    paths, revolute = geometry.joint_paths, geometry.skeleton.revolute
    for joint, name in enumerate(geometry.leg.joint_names):
        body = geometry.leg.tree_joint_names.index(name)
        yield Readings(
            name,
            paths[body],
            geometry.joint_colours[body],
            np.rad2deg(trajectory.q[:, joint]) if revolute[body] else 1e3 * trajectory.q[:, joint],
            trajectory.tau[:, joint],
            None if predicted is None else predicted[:, joint],
            trajectory.measured,
            ("°", "N·m") if revolute[body] else ("mm", "N"),
        )


def _numbers(values: FloatArray) -> list[float | None]:
    """Round to four significant digits; None for what is not a number."""
    return [float(f"{value:.4g}") if np.isfinite(value) else None for value in values]
