"""Building a scene from legs, poses and recordings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.estimate import Estimate
from exoid.leg.leg import Leg
from exoid.signals import Recording

from .commands import Layer, set_animation
from .leg_geometry import LegGeometry
from .leg_view import view_leg
from .readings import joint_readings
from .replay import Replay
from .scene import Scene
from .skeleton import pose_angles
from .surroundings import camera, draw_surroundings, view_direction


def scene(
    *legs: Leg | Estimate,
    pose: Mapping[str, float] | None = None,
    recording: Recording | None = None,
    identified: Sequence[Leg] = (),
    meshes: str | Path | None = None,
    title: str | None = None,
) -> Scene:
    """Draw one or several legs of an exoskeleton, standing still or replaying a recording.

    Links are drawn by the URDF's ``<visual>`` elements. Bodies without any get joint housings, bars and a foot. Centres
    of mass are steel balls of the body's mass. Inertias are ellipsoids of uniform density with the same inertia.
    Straight arrows are weights. Circular arrows around the joint axes are actuator torques: the recorded ones, or those
    that hold the leg against gravity. Their area is proportional to the torque. A floating base moves by its recorded
    pose, or by the feet that rest on the ground; arrows from the centres of pressure are forces of the ground.

    Args:
        *legs: Legs that share a torso. An estimate shows the leg that it belongs to, with CAD inertias and identified
            inertias (:func:`exoid.leg.lift.lift`).
        pose: Angles by joint name [rad]; zero for joints that are not named.
        recording: Motion to replay in real time, and torques if it has any. Legs without recorded joints stand still.
        identified: The same legs with identified inertias, to draw beside their own.
        meshes: Folder in which the URDF's meshes are searched.
        title: Title of the page; None for the names of the legs.

    Returns:
        The scene: ``.save("leg.html")``, ``.serve()``, or the last expression of a notebook's cell.

    Raises:
        ExoidError: There is no leg, a joint is unknown, the recording has only some joints of a leg, an attribute of a
            ``<visual>`` is not a number, the leg is too large, or a wrench in axes of the laboratory has no pose.

    Example:
        >>> exoid.view.scene(exoid.load_leg("bleex"), pose={"left_knee": -0.6}).save("leg.html")  # doctest: +SKIP
    """
    if not legs:
        raise BadArgumentError("no leg to draw", remedy="pass a Leg or an Estimate")
    replay = None if recording is None else Replay.of(recording)
    geometries = _geometries(legs, identified, None if meshes is None else Path(meshes))
    poses = pose_angles([geometry.leg for geometry in geometries], pose or {})
    if recording is not None:
        _check_joints(geometries, recording)
    views = [view_leg(leg, geometry, q, replay) for leg, geometry, q in zip(legs, geometries, poses, strict=True)]
    floors = [view.floor for view in views if view.floor is not None]
    points = np.vstack([view.points for view in views])
    _check_size(points, geometries)
    direction = view_direction(geometries)
    commands = [
        *draw_surroundings(points, direction, min(floors, default=None)),
        *(command for view in views for command in view.drawing.commands),
    ]
    if tracks := {path: track for view in views for path, track in view.drawing.tracks.items()}:
        commands.append(set_animation(tracks))
    robot = Path(geometries[0].leg.description.name).stem
    names = [robot, *(name for name in map(_leg_name, geometries) if name != robot)]
    return Scene(
        title or ", ".join(names),
        tuple(commands),
        _merge([(_leg_name(geometry), view.drawing.layers) for geometry, view in zip(geometries, views, strict=True)]),
        camera(np.vstack([view.seen for view in views]), direction),
        0.0 if replay is None else replay.duration,
        tuple(note for geometry in geometries for note in geometry.notes)
        + tuple(note for view in views for note in view.drawing.notes),
        tuple(
            reading
            for leg, geometry, q in zip(legs, geometries, poses, strict=True)
            for reading in joint_readings(leg, geometry, q, replay)
        )
        + tuple(reading for view in views for reading in view.feet),
    )


def _geometries(legs: Sequence[Leg | Estimate], identified: Sequence[Leg], folder: Path | None) -> list[LegGeometry]:
    """Make the geometry of each leg, with a unique path; legs of one URDF share a torso, which is drawn once."""
    geometries: list[LegGeometry] = []
    for leg in legs:
        geometry = LegGeometry.of(leg, identified, folder)
        if any(other.root == geometry.root for other in geometries):
            geometry = replace(geometry, root=f"{geometry.root} {len(geometries) + 1}")
        if any(other.leg.description.sha256 == geometry.leg.description.sha256 for other in geometries):
            geometry = replace(geometry, visuals=((), *geometry.visuals[1:]))
        geometries.append(geometry)
    return geometries


def _check_size(points: FloatArray, geometries: Sequence[LegGeometry]) -> None:
    """Raise an error if the legs are too large to be drawn."""
    size = float(np.abs(points).max())
    if not size < 100.0:  # [m]; a URDF in millimetres exceeds it
        raise BadArgumentError(
            f"the leg extends to {size:.3g} m, too far to be drawn",
            where=", ".join(dict.fromkeys(geometry.leg.description.name for geometry in geometries)),
            remedy="check that lengths in the URDF are metres, and the scale of its meshes",
        )


def _check_joints(geometries: Sequence[LegGeometry], recording: Recording) -> None:
    """Raise an error if a recording has no joint of any leg."""
    names = {name for geometry in geometries for name in geometry.leg.joint_names}
    labels = {*geometries[0].leg.joint_labels} if len(geometries) == 1 else set()  # of two legs they are the same
    if not (names | labels) & set(recording.joint_names):
        raise BadArgumentError(
            f"none of the logged joints ({', '.join(recording.joint_names)}) belongs to the leg",
            remedy=f"map the log's columns to {', '.join(sorted(names))}",
        )


def _leg_name(geometry: LegGeometry) -> str:
    """Name of a leg in the scene."""
    return geometry.root.rsplit("/", 1)[1]


def _merge(legs: Sequence[tuple[str, Sequence[Layer]]]) -> tuple[Layer, ...]:
    """Merge layers of several legs that have the same label; scales that differ are those of named legs."""
    merged: dict[str, Layer] = {}
    scales: dict[str, dict[str, str]] = {}
    for name, layers in legs:
        for layer in layers:
            before = merged.setdefault(layer.label, layer._replace(paths=()))
            merged[layer.label] = before._replace(paths=(*before.paths, *layer.paths))
            if layer.scale:
                scales.setdefault(layer.label, {})[name] = layer.scale
    for label, by_leg in scales.items():
        named = "; ".join(f"{name}: {scale}" for name, scale in by_leg.items())
        same = len(set(by_leg.values())) == 1
        merged[label] = merged[label]._replace(scale=next(iter(by_leg.values())) if same else named)
    return tuple(merged.values())
