"""Arrows of the wearer's torque around the joint axes, beside those of the actuators."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.control.wearer import Interaction
from exoid.leg.leg import Leg
from exoid.view.colours import WEARER

from .arrows import circular_arrow, torque_scale
from .commands import Command, Tracks, set_object, set_transform
from .forces import THICKNESS, TORQUE_RADIUS
from .leg_geometry import LegGeometry
from .leg_trajectory import LegTrajectory
from .leg_view import LegView
from .replay import Replay
from .scene import Layer
from .transforms import align_z, homogeneous

BESIDE = 0.05
"""Distance along the joint's axis from the actuator's arrow to that of the wearer, over the reach of the leg."""

GAP = 0.03
"""Largest time between a frame and a sample whose torque is drawn [s]."""


def with_interaction(view: LegView, geometry: LegGeometry, replay: Replay, found: Interaction) -> LegView:
    """Add arrows of the wearer's torque to a leg."""
    # A torque as large as the largest of the actuators has an arrow of the same size.
    leg = geometry.leg
    if not {*leg.joint_names} <= {*found.joint_names}:
        return view
    torque, reach = _at_frames(leg, replay, found), geometry.skeleton.reach
    posed = np.zeros(len(leg.joint_names))
    largest = float(np.abs(LegTrajectory.of(leg, posed, replay).tau).max()) or float(np.abs(torque).max())
    commands: list[Command] = list(view.commands)
    tracks: Tracks = dict(view.tracks)
    paths = []
    for path, axis, of_joint in zip(geometry.joint_paths(geometry.root), geometry.skeleton.axes, torque.T, strict=True):
        place, scale = f"{path}/wearer", torque_scale(of_joint, largest)
        arrow = circular_arrow(TORQUE_RADIUS * reach, THICKNESS * reach, WEARER)
        commands += [
            set_object(f"{place}/arrow", arrow, shadows=False),
            set_transform(place, homogeneous(BESIDE * reach * axis, align_z(axis))),
            set_transform(f"{place}/arrow", np.diag([*scale[0], 1.0])),
        ]
        if len(scale) > 1:
            tracks[f"{place}/arrow"] = {"scale": scale}
        paths.append(place)
    layers = [
        *view.layers,
        Layer("torque of the wearer", (WEARER,), tuple(paths), scale="same scale as the actuators'"),
    ]
    return view._replace(commands=commands, layers=layers, tracks=tracks)


def _at_frames(leg: Leg, replay: Replay, found: Interaction) -> FloatArray:
    """Torque at the frames [N·m], (F, n); zero where there is none."""
    places = [found.joint_names.index(name) for name in leg.joint_names]
    torque = np.nan_to_num(found.torque[:, places])
    after = np.clip(np.searchsorted(found.time, replay.time), 1, len(found.time) - 1)
    distance = np.minimum(np.abs(found.time[after] - replay.time), np.abs(replay.time - found.time[after - 1]))
    columns = [np.interp(replay.time, found.time, column) for column in torque.T]
    return np.asarray(np.column_stack(columns) * (distance < GAP)[:, np.newaxis])
