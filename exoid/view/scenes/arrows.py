"""Arrows: straight ones for weights, circular ones around joint axes for torques of actuators."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.view.colours import WEIGHT

from .commands import Drawing, Layer, child_path, moving, set_object, set_transform
from .leg_geometry import LegGeometry
from .replay import LegTrajectory
from .transforms import align_z, homogeneous
from .visual import Material, Visual, cylinder, torus

WEIGHT_LENGTH, TORQUE_RADIUS, THICKNESS = 0.3, 0.17, 0.011
"""Length of the heaviest body's arrow, radius of the largest torque's, and thickness, over the reach of the leg."""

SMALLEST_SCALE = 1e-3
"""Scale of an arrow of zero torque: a scale of 0 has no inverse."""


def straight_arrow(length: float, thickness: float, colour: str) -> list[Visual]:
    """Make an arrow from the origin along z, of a length and a thickness [m]."""
    material, head = Material(colour, finish="flat"), min(5.0 * thickness, 0.5 * length)
    shaft = cylinder(0.5 * thickness, length - head, material)
    tip = cylinder(1.5 * thickness, head, material, top_radius=0.0)
    return [
        shaft.placed(homogeneous((0.0, 0.0, 0.5 * (length - head)))),
        tip.placed(homogeneous((0.0, 0.0, length - 0.5 * head))),
    ]


def circular_arrow(radius: float, thickness: float, colour: str) -> list[Visual]:
    """Make an arrow of a radius and a thickness [m] around z, counter-clockwise, with its gap at negative x."""
    material, head = Material(colour, finish="flat"), 5.5 * thickness
    arc = np.deg2rad(250.0)
    c, s = np.cos(0.5 * arc), np.sin(0.5 * arc)
    tangent = align_z((-s, c, 0.0), (0.0, 0.0, 1.0))
    end = np.array([c, s, 0.0]) * radius + 0.45 * head * tangent[:, 2]
    backward = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])  # rotation by half the arc
    return [
        torus(radius, 0.5 * thickness, arc, material).placed(homogeneous(np.zeros(3), backward)),
        cylinder(1.6 * thickness, head, material, top_radius=0.0).placed(homogeneous(end, tangent)),
    ]


def draw_weights(geometry: LegGeometry, trajectory: LegTrajectory, down: FloatArray) -> Drawing:
    """Draw an arrow for the weight of each body, its length proportional to the weight."""
    reach, inertias, drawing = geometry.skeleton.reach, geometry.inertias[-1].bodies, Drawing()
    heaviest = max(inertia.mass for inertia in inertias)
    bodies = geometry.skeleton.body_placements(trajectory.q)[:, 1:]
    paths = [child_path(geometry.root, f"weight {name}") for name in geometry.leg.bodies[-len(inertias) :]]
    for body, (path, inertia) in enumerate(zip(paths, inertias, strict=True)):
        arrow = straight_arrow(WEIGHT_LENGTH * reach * inertia.mass / heaviest, THICKNESS * reach, WEIGHT)
        centre = bodies[:, body, :3, :3] @ inertia.lever + bodies[:, body, :3, 3]
        drawing += Drawing([set_object(path, arrow, shadows=False)]) + moving(path, centre, down)
    weight = heaviest * float(np.linalg.norm(geometry.leg.model.gravity.linear))
    scale = f"arrow of {WEIGHT_LENGTH * reach:.2g} m = {weight:.3g} N"
    return drawing + Drawing(layers=[Layer("weights", (WEIGHT,), tuple(paths), scale=scale)])


def draw_torques(geometry: LegGeometry, trajectory: LegTrajectory) -> Drawing:
    """Draw the torque of each driven joint around its axis, measured or against gravity."""
    leg, reach, drawing, paths = geometry.leg, geometry.skeleton.reach, Drawing(), []
    largest = float(np.abs(trajectory.tau).max())
    every = zip(geometry.joint_paths, geometry.skeleton.axes, geometry.joint_colours, strict=True)
    driven = [each for each, name in zip(every, leg.tree_joint_names, strict=True) if name in leg.joint_names]
    for (joint, axis, colour), torque in zip(driven, trajectory.tau.T, strict=True):
        place, path = f"{joint}/torque", f"{joint}/torque/arrow"
        arrow = circular_arrow(TORQUE_RADIUS * reach, THICKNESS * reach, colour)
        turn = homogeneous(np.zeros(3), align_z(axis))
        drawing += Drawing([set_object(path, arrow, shadows=False), set_transform(place, turn)])
        # The area of an arrow is proportional to the torque, and its direction is the sign.
        size = np.maximum(np.sqrt(np.abs(torque) / (largest or 1.0)), SMALLEST_SCALE)
        scales = np.column_stack([size, np.where(torque < 0.0, -size, size), size])
        drawing += moving(path, np.zeros((1, 3)), scale=scales)
        paths.append(place)
    unit = "N·m" if all(geometry.skeleton.revolute) else "N·m or N"
    scale = f"radius of {TORQUE_RADIUS * reach:.2g} m = {largest:.3g} {unit}" if largest else ""
    label = "measured torque" if trajectory.measured else "torque against gravity"
    colours = tuple(dict.fromkeys(geometry.joint_colours))
    return drawing + Drawing(layers=[Layer(label, colours, tuple(paths), scale=scale)])
