"""The ``<visual>`` elements of a URDF, which yourdfpy reads."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from lxml import etree

from exoid.leg.description import Description, check_numbers

from .mesh_search import find_mesh
from .meshes import load_mesh
from .visual import Material, Visual, box, cylinder, ellipsoid, hex_colour, triangle_mesh

if TYPE_CHECKING:
    import yourdfpy

PLAIN = "#b8bcc2"
"""Colour of a link to which neither the URDF nor the file of its mesh gives one."""

SHAPES = ("box", "cylinder", "sphere", "mesh")
"""Tags of the geometries that are drawn."""

NUMBERS = {
    "material/color": {"rgba": 4},
    "link/visual/material/color": {"rgba": 4},
    "link/visual/origin": {"xyz": 3, "rpy": 3},
    "link/visual/geometry/box": {"size": 3},
    "link/visual/geometry/cylinder": {"radius": 1, "length": 1},
    "link/visual/geometry/sphere": {"radius": 1},
    "link/visual/geometry/mesh": {"scale": 3},
}
"""Number of values in each attribute. yourdfpy takes other numbers of them, and values that are not finite."""

REQUIRED = ("box", "color", "cylinder", "sphere")
"""Tags of elements that must have all of these attributes."""


def read_visuals(
    description: Description, links: Sequence[str], folder: Path | None
) -> tuple[dict[str, list[Visual]], tuple[str, ...]]:
    """Read the visuals of links in their frames, by name; and a sentence for each that cannot be drawn."""
    import yourdfpy  # noqa: PLC0415 - takes a second, with trimesh

    by_link: dict[str, list[Visual]] = {}
    root, unknown = _drawn_elements(description.parse(), links)
    what = "a <visual> that is no box, cylinder, sphere or mesh, left out"
    notes = [f"{description.name}, link {name!r}: {what}" for name in unknown]
    check_numbers(root, NUMBERS, REQUIRED, description.name)
    robot = yourdfpy.URDF.load(BytesIO(etree.tostring(root)), build_scene_graph=False, load_meshes=False).robot
    named = {material.name: material for material in robot.materials}
    for link in robot.links:
        for visual in link.visuals:
            try:
                drawn = _shapes(visual, named, folder)
            except FileNotFoundError as missing:
                notes.append(f"{description.name}, link {link.name!r}: {missing}, left out")
                continue
            origin = np.eye(4) if visual.origin is None else visual.origin
            by_link.setdefault(link.name, []).extend(shape.placed(origin) for shape in drawn)
    return by_link, tuple(notes)


def _drawn_elements(root: etree._Element, links: Sequence[str]) -> tuple[etree._Element, list[str]]:
    """Copy materials and visuals of links, without all else, whose faults are of no consequence here."""
    robot, unknown = etree.Element("robot", name=root.get("name", "")), []
    robot.extend(root.findall("material"))
    for link in [link for link in root.findall("link") if link.get("name") in links]:
        copy = etree.SubElement(robot, "link", name=link.get("name", ""))
        for visual in link.findall("visual"):
            geometry = visual.find("geometry")
            shape = next((each for each in (() if geometry is None else geometry) if each.tag in SHAPES), None)
            if geometry is None or shape is None:
                unknown.append(link.get("name", ""))
                continue
            geometry[:] = [shape]  # the first child is the one that yourdfpy reads
            copy.append(visual)
    return robot, unknown


def _shapes(visual: yourdfpy.Visual, named: dict[str, yourdfpy.Material], folder: Path | None) -> Iterable[Visual]:
    """Shapes of a visual, in its own frame."""
    material, geometry = _material(visual.material, named), visual.geometry
    if geometry.mesh is not None:
        return _mesh(geometry.mesh, material, folder)
    material = material or Material(PLAIN)
    if geometry.box is not None:
        return [box(geometry.box.size, material)]
    if geometry.cylinder is not None:
        return [cylinder(geometry.cylinder.radius, geometry.cylinder.length, material)]
    return [ellipsoid(geometry.sphere.radius, material)]


def _mesh(mesh: yourdfpy.Mesh, material: Material | None, folder: Path | None) -> list[Visual]:
    """Read a mesh, in the material of the URDF or in its own colours; raise FileNotFoundError if there is none."""
    path = find_mesh(mesh.filename or "", folder)
    try:
        parts = load_mesh(path, np.ones(3) if mesh.scale is None else mesh.scale)
    except Exception as error:  # the reader of meshes raises errors of several kinds
        raise FileNotFoundError(f"mesh {mesh.filename!r} cannot be read ({error})") from error
    return [
        triangle_mesh(part.points, part.normals, part.triangles, material or Material(part.colour or PLAIN))
        for part in parts
    ]


def _material(material: yourdfpy.Material | None, named: dict[str, yourdfpy.Material]) -> Material | None:
    """Material of a visual, or that of its name among the robot's materials; None if neither has a colour."""
    if material is None:
        return None
    given = [each for each in (material, named.get(material.name)) if each is not None and each.color is not None]
    if not given:
        return None
    rgba = np.clip(given[0].color.rgba, 0.0, 1.0)
    return Material(hex_colour(*(round(255.0 * float(value)) for value in rgba[:3])), float(rgba[3]))
