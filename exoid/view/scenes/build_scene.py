"""Setting the stage: legs, ground, light and camera."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.leg import Leg
from exoid.signals import Recording

from .commands import Command, animate, place, set_property, show
from .leg_geometry import Figure
from .leg_view import act
from .parts import Look, Part, box, cylinder, moved, towards
from .replay import Replay
from .scene import Camera, Layer, Scene
from .skeleton import joint_angles

GROUND = Look("#c8ced6", finish="matte")
LINES = Look("#b9bfc8", finish="flat")

GRID = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
"""Steps of the lines on the ground [m]."""

CAMERA = {
    "metadata": {"version": 4.5, "type": "Object"},
    "object": {"uuid": "camera", "type": "PerspectiveCamera", "fov": 28, "aspect": 1.5, "near": 0.01, "far": 200},
}
"""With a field of view of 28°: nearly parallel, so that lengths compare."""

LARGEST = 100.0
"""Distance from the origin that is too far [m]: a URDF in millimetres."""

SMALLEST = 0.01
"""Half the size of what fills the picture, at least [m]."""

ROOT = "/exoid"
"""Path of everything exoid draws."""


def scene(
    *legs: Leg | Estimate,
    pose: Mapping[str, float] | None = None,
    recording: Recording | None = None,
    ghost: Recording | None = None,
    ghost_label: str = "reference",
    identified: Sequence[Leg] = (),
    meshes: str | Path | None = None,
    title: str | None = None,
) -> Scene:
    """Draw one or several legs of one exoskeleton, standing still or replaying a recording.

    Links look as the URDF's ``<visual>`` elements say; where there are none, as bars, joint housings and a foot made
    from the leg's own geometry. Centres of mass are steel balls of the mass there, inertias the ellipsoids of even
    density with the same inertia. Round arrows about the joints are actuator torques, their area in proportion to
    the torque: those recorded, else those that hold the pose against gravity. Straight arrows are weights.

    Args:
        legs: Legs that share a torso. An estimate shows the leg it belongs to, and beside its inertias those identified
            (:func:`exoid.lift.lift`).
        pose: Angle of joints by name [rad]; zero where not given.
        recording: Motion to replay in real time, and torques if it has any. A leg none of whose joints it has stands
            still.
        ghost: Motion of a second, translucent leg on the same time axis: what a reference asks, or what a model
            predicts (:func:`exoid.identification.predict_motion`).
        ghost_label: What the legend calls it.
        identified: The same legs with other parameters, whose inertias stand beside their own.
        meshes: Folder in which the URDF's meshes are looked for.
        title: Of the page; by default the names of the legs.

    Returns:
        The scene: ``.save("leg.html")``, ``.serve()``, or the last expression of a notebook's cell.

    Raises:
        ExoidError: There is no leg, a joint is unknown, the recording has only some joints of a leg, a number in a
            ``<visual>`` is none, or the leg is too large.

    Example:
        >>> exoid.view.scene(exoid.load_leg("bleex"), pose={"left_knee": -0.6}).save("leg.html")  # doctest: +SKIP
    """
    if not legs:
        raise ExoidError("no leg to draw", remedy="pass a Leg or an Estimate")
    if ghost is not None and recording is None:
        raise ExoidError("a second motion beside none", remedy="pass it as recording=")
    replay = None if recording is None else Replay.of(recording, ghost)
    figures = _figures(legs, identified, None if meshes is None else Path(meshes))
    angles = _angles(figures, pose or {})
    _check_recorded(figures, recording, ghost)
    acts = [act(figure, q, replay, ghost_label) for figure, q in zip(figures, angles, strict=True)]
    tracks = {path: track for each in acts for path, track in each.tracks.items()}
    points = _checked(np.vstack([each.extent for each in acts]), figures)
    direction = _direction(figures)
    commands = [*_surroundings(points, direction), *(command for each in acts for command in each.commands)]
    return Scene(
        title or _title(figures),
        (*commands, *([animate(tracks)] if tracks else [])),
        _merged(layer for each in acts for layer in each.layers),
        _camera(points, direction),
        0.0 if replay is None else replay.duration,
        tuple(each.standing for each in acts),
        tuple(note for figure in figures for note in figure.notes),
    )


def _figures(legs: Sequence[Leg | Estimate], identified: Sequence[Leg], folder: Path | None) -> list[Figure]:
    """Make the figures, each with a path of its own and a torso that is drawn once."""
    figures: list[Figure] = []
    for each in legs:
        figure = Figure.of(each, identified, folder, ROOT)
        if any(other.root == figure.root for other in figures):
            figure = replace(figure, root=f"{figure.root} {len(figures) + 1}")
        if any(other.leg.description.sha256 == figure.leg.description.sha256 for other in figures):
            figure = figure.without_torso()
        figures.append(figure)
    return figures


def _checked(points: FloatArray, figures: Sequence[Figure]) -> FloatArray:
    """Refuse what no camera can take in."""
    size = float(np.abs(points).max())
    if not size < LARGEST:
        raise ExoidError(
            f"it reaches {size:.3g} m, too far to be drawn",
            where=", ".join(dict.fromkeys(figure.leg.description.name for figure in figures)),
            remedy="check that lengths in the URDF are metres, and the scale of its meshes",
        )
    return points


def _angles(figures: Sequence[Figure], pose: Mapping[str, float]) -> list[FloatArray]:
    names = [name for figure in figures for name in figure.leg.joint_names]
    unknown = [name for name in pose if name not in names]
    if unknown:
        raise ExoidError(f"no joint {', '.join(unknown)}", remedy=f"the legs have {', '.join(names)}")
    return [joint_angles(figure.leg.joint_names, pose) for figure in figures]


def _check_recorded(figures: Sequence[Figure], *recordings: Recording | None) -> None:
    names = {name for figure in figures for name in figure.leg.joint_names}
    for recording in recordings:
        if recording is not None and not names & set(recording.joint_names):
            raise ExoidError(
                f"none of the logged joints ({', '.join(recording.joint_names)}) is one of the leg's",
                remedy=f"map the log's columns to {', '.join(sorted(names))}",
            )


def _title(figures: Sequence[Figure]) -> str:
    robot = Path(figures[0].leg.description.name).stem
    of_legs = [figure.root.rsplit("/", 1)[1] for figure in figures]
    return ", ".join([robot, *(name for name in of_legs if name != robot)])


def _merged(layers: Iterable[Layer]) -> tuple[Layer, ...]:
    """Join layers of several legs that have the same label."""
    merged: dict[str, Layer] = {}
    for layer in layers:
        before = merged.get(layer.label, layer._replace(paths=()))
        merged[layer.label] = before._replace(paths=(*before.paths, *layer.paths))
    return tuple(merged.values())


def _direction(figures: Sequence[Figure]) -> FloatArray:
    """Direction to look from: one leg from the side that is away from what it hangs on, several more from the front."""
    torsos = [point for figure in figures if figure.shapes[0] for part in figure.shapes[0] for point in part.extent]
    middle = np.mean([*torsos, np.zeros(3)], axis=0)
    hips = np.mean([figure.skeleton.placements[0][:3, 3] for figure in figures], axis=0)
    side = -1.0 if hips[1] < middle[1] - 1e-3 else 1.0
    direction = np.array([0.62, 0.78 * side, 0.22] if len(figures) == 1 else [0.87, 0.44, 0.22])
    return np.asarray(direction / np.linalg.norm(direction))


def _camera(points: FloatArray, direction: FloatArray) -> Camera:
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    frame = towards(direction, (0.0, 0.0, 1.0))  # across the picture, upwards, to the camera
    reach = np.abs((points - centre) @ frame).max(axis=0)
    half_width, half_height, half_depth = np.maximum(reach, SMALLEST).tolist()
    return Camera(tuple(centre.tolist()), tuple(direction.tolist()), half_width, half_height, half_depth)


def _surroundings(points: FloatArray, direction: FloatArray) -> Iterator[Command]:
    """Background, ground, light and camera."""
    lower, upper = points.min(axis=0), points.max(axis=0)
    centre, size = 0.5 * (lower + upper), max(float(np.linalg.norm(upper - lower)), SMALLEST)
    for name, value in (("top_color", [1.0, 1.0, 1.0]), ("bottom_color", [0.9, 0.91, 0.93])):
        yield set_property("/Background", name, value)
    for path in ("/Grid", "/Axes"):
        yield set_property(path, "visible", False)
    yield show(f"{ROOT}/ground", _ground(size))
    yield place(f"{ROOT}/ground", moved((centre[0], centre[1], lower[2] - 0.002 * size)))
    spot = "/Lights/SpotLight/<object>"
    above = size * np.array([0.6 * direction[0], 0.5 * direction[1], 1.6]) + centre
    yield set_property("/Lights/SpotLight", "visible", True)
    yield set_property(spot, "castShadow", True)
    for light, intensity in (("AmbientLight", 0.5), ("FillLight", 0.2), ("SpotLight", 0.3)):
        yield set_property(f"/Lights/{light}/<object>", "intensity", intensity)
    yield set_property(spot, "position", above.tolist())
    yield {"type": "set_object", "path": "/Cameras/default/rotated", "object": CAMERA}


def _ground(size: float) -> list[Part]:
    radius = 0.5 * size
    step = max((each for each in GRID if each <= 0.3 * radius), default=GRID[0])
    thin = 0.002 * size
    disc = cylinder(radius, thin, GROUND).at(moved((0.0, 0.0, -0.5 * thin)))
    lines = []
    for offset in np.arange(-np.floor(radius / step), np.floor(radius / step) + 1.0) * step:
        length = 2.0 * float(np.sqrt(max(radius**2 - offset**2, 0.0)))
        lines.append(box((length, thin, 0.2 * thin), LINES).at(moved((0.0, offset, 0.0))))
        lines.append(box((thin, length, 0.2 * thin), LINES).at(moved((offset, 0.0, 0.0))))
    return [disc, *lines]
