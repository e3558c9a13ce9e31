"""Drawing of one leg in a scene: posed or moving, with its forces."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.estimate import Estimate
from exoid.leg.leg import Leg
from exoid.leg.torso import tilted_gravity

from .arrows import draw_torques, draw_weights
from .commands import Drawing, Layer, moving, set_transform
from .ground_arrows import draw_ground_forces, foot_readings, ground_loads
from .leg_geometry import LegGeometry
from .placeholders import FRAME
from .readings import Readings
from .replay import LegTrajectory, Replay
from .standing import Standing
from .transforms import align_z, quaternions
from .urdf_visuals import PLAIN


class LegView(NamedTuple):
    """One leg in a scene."""

    drawing: Drawing  # the leg, its forces and their motion
    points: FloatArray  # points whose convex hull contains the leg [m], (k, 3)
    seen: FloatArray  # points whose convex hull contains the leg and its ellipsoids [m], (k, 3)
    floor: float | None  # height of the ground [m] where the base moves, else None
    feet: tuple[Readings, ...]  # numbers of feet on the ground


def view_leg(source: Leg | Estimate, geometry: LegGeometry, q: FloatArray, replay: Replay | None) -> LegView:
    """Draw a leg in a pose, or replaying a recording; its base moves where a recording tells how."""
    trajectory = LegTrajectory.of(geometry.leg, q, replay)
    base = None if replay is None else Standing.of(geometry, replay)
    torso = geometry.skeleton.torso_placement(trajectory.pitch)
    if base is None:
        down = align_z(tilted_gravity(geometry.leg.plane, trajectory.pitch))
        drawing = Drawing([set_transform(geometry.root, torso)])
    else:
        down = np.swapaxes(base.rotation, 1, 2) @ align_z((0.0, 0.0, -1.0))
        drawing = moving(geometry.root, base.position, base.rotation)
    drawing += Drawing([*geometry.pose(trajectory.q[0])])
    points, (leg, *others) = geometry.bounding_points(trajectory.q), _bodies(geometry)
    drawing += leg
    for each in (*others, draw_weights(geometry, trajectory, down), draw_torques(geometry, trajectory)):
        drawing += each
    if len(trajectory.q) > 1:
        turns, places = np.split(geometry.skeleton.joint_transforms(trajectory.q)[..., :3, :], [3], axis=-1)
        moves = [
            {"quaternion": quaternions(turns[:, joint])} if revolute else {"position": places[:, joint, :, 0]}
            for joint, revolute in enumerate(geometry.skeleton.revolute)
        ]
        drawing += Drawing(tracks=dict(zip(geometry.body_paths[1:], moves, strict=True)))
    feet: tuple[Readings, ...] = ()
    if replay is not None and base is not None:
        loads, notes = ground_loads(source, geometry.leg, replay, base)
        drawing += draw_ground_forces(geometry, replay, base, loads) + Drawing(notes=notes)
        feet = tuple(foot_readings(geometry, loads))
    # The camera stays on the leg: arrows of forces, which may be long, do not count.
    seen = np.vstack([points, geometry.bounding_points(trajectory.q, ellipsoids=True)])
    points, seen = (_placed(each, torso, base) for each in (points, seen))
    return LegView(drawing, points, seen, None if base is None else base.floor, feet)


def _placed(points: FloatArray, torso: FloatArray, base: Standing | None) -> FloatArray:
    """Place points of the torso's frame; where the base moves, the corners of their box at some of the frames."""
    if base is None:
        return np.asarray(points @ torso[:3, :3].T + torso[:3, 3])
    box = np.array(np.meshgrid(*zip(points.min(axis=0), points.max(axis=0), strict=True))).reshape(3, -1).T
    few = np.linspace(0, len(base.position) - 1, min(60, len(base.position))).astype(np.intp)
    return np.vstack([box @ base.rotation[frame].T + base.position[frame] for frame in few])


def _bodies(geometry: LegGeometry) -> Iterator[Drawing]:
    """Layers of what moves with the bodies, the leg first."""
    layers = [
        ("leg", (PLAIN,), geometry.draw_bodies()),
        ("joint axes", tuple(dict.fromkeys(geometry.joint_colours)), geometry.draw_axes()),
        ("centres of mass", tuple(inertias.colour for inertias in geometry.inertias), geometry.draw_masses()),
    ]
    if geometry.leg.closure is not None:
        layers.append(("closed loops", (FRAME.colour,), geometry.draw_loops()))
    for inertias in geometry.inertias:
        layers.append((f"{inertias.label} inertia", (inertias.colour,), geometry.draw_inertias(inertias)))
    for label, colours, drawn in layers:
        commands = list(drawn)
        yield Drawing(commands, [Layer(label, colours, tuple(command["path"] for command in commands))])
