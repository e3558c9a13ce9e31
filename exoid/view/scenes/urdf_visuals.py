"""The ``<visual>`` elements of a URDF."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
import pinocchio as pin
from lxml import etree

from exoid.leg.description import Description, check_numbers
from exoid.leg.rewriting import numbers_of

from .mesh_search import find_mesh
from .meshes import load_mesh
from .visual import Material, Visual, box, cylinder, ellipsoid, hex_colour, triangle_mesh

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
"""Number of values in each attribute."""

REQUIRED = ("box", "color", "cylinder", "sphere")
"""Tags of elements that must have all of these attributes."""


def read_visuals(
    description: Description, links: Sequence[str], folder: Path | None
) -> tuple[dict[str, list[Visual]], tuple[str, ...]]:
    """Read the visuals of links in their frames, by name; and a sentence for each that cannot be drawn."""
    by_link: dict[str, list[Visual]] = {}
    root, unknown = _drawn_elements(description.parse(), links)
    notes = [f"{description.name}, link {each!r}: a <visual> of no shape that is drawn, left out" for each in unknown]
    check_numbers(root, NUMBERS, REQUIRED, description.name)
    coloured = ((element.get("name", ""), _material(element)) for element in root.findall("material"))
    named = {name: material for name, material in coloured if material is not None}
    for visual in root.iterfind("link/visual"):
        link = visual.getparent().get("name", "")  # type: ignore[union-attr]
        try:
            drawn = _shapes(visual, named, folder)
        except FileNotFoundError as missing:
            notes.append(f"{description.name}, link {link!r}: {missing}, left out")
            continue
        origin = visual.find("origin")
        place = pin.SE3(pin.rpy.rpyToMatrix(numbers_of(origin, "rpy")), numbers_of(origin, "xyz")).homogeneous
        by_link.setdefault(link, []).extend(shape.placed(place) for shape in drawn)
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
            geometry[:] = [shape]
            copy.append(visual)
    return robot, unknown


def _shapes(visual: etree._Element, named: dict[str, Material], folder: Path | None) -> Iterable[Visual]:
    """Shapes of a visual, in its own frame."""
    element = visual.find("material")
    material = None if element is None else _material(element) or named.get(element.get("name", ""))
    (shape,) = visual.iterfind("geometry/*")
    if shape.tag == "mesh":
        return _mesh(shape, material, folder)
    material = material or Material(PLAIN)
    if shape.tag == "box":
        return [box(numbers_of(shape, "size"), material)]
    radius = float(shape.get("radius", ""))
    if shape.tag == "cylinder":
        return [cylinder(radius, float(shape.get("length", "")), material)]
    return [ellipsoid(radius, material)]


def _mesh(mesh: etree._Element, material: Material | None, folder: Path | None) -> list[Visual]:
    """Read a mesh, in the material of the URDF or in its own colours; raise FileNotFoundError if there is none."""
    name = mesh.get("filename", "")
    path = find_mesh(name, folder)
    try:
        parts = load_mesh(path, numbers_of(mesh, "scale", "1 1 1"))
    except Exception as error:  # the reader of meshes raises errors of several kinds
        raise FileNotFoundError(f"mesh {name!r} cannot be read ({error})") from error
    return [
        triangle_mesh(part.points, part.normals, part.triangles, material or Material(part.colour or PLAIN))
        for part in parts
    ]


def _material(element: etree._Element) -> Material | None:
    """Material with a colour; None if it has none."""
    colour = element.find("color")
    if colour is None:
        return None
    rgba = np.clip(numbers_of(colour, "rgba"), 0.0, 1.0).tolist()
    return Material(hex_colour(*(round(255.0 * value) for value in rgba[:3])), rgba[3])
