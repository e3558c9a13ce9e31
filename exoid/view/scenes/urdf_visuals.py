"""The ``<visual>`` elements of a URDF."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pinocchio as pin
from lxml import etree

from exoid._typing import FloatArray
from exoid.description import Description
from exoid.errors import ExoidError

from .meshes import find_mesh, load_mesh
from .transforms import homogeneous
from .visual import Material, Visual, box, cylinder, ellipsoid, triangle_mesh

PLAIN = "#b8bcc2"
"""Colour of a link to which the URDF gives none."""


class LinkVisuals(NamedTuple):
    """Visuals of links.

    Attributes:
        by_link: Visuals in the link's frame, by the name of each link that has any.
        notes: One sentence for each mesh that is missing.
    """

    by_link: dict[str, list[Visual]]
    notes: tuple[str, ...]


def read_visuals(description: Description, links: Sequence[str], folder: Path | None) -> LinkVisuals:
    """Read the ``<visual>`` elements of links.

    Args:
        description: The URDF.
        links: Names of the requested links.
        folder: Folder in which meshes are searched; see :func:`.meshes.find_mesh`.

    Returns:
        Visuals by link, and notes on missing meshes.

    Raises:
        ExoidError: An attribute of a ``<visual>`` is not a number.
    """
    root = description.parse()
    colours = {m.get("name", ""): _colour(m, description.name) for m in root.findall("material")}
    by_link: dict[str, list[Visual]] = {}
    notes: list[str] = []
    for link in root.findall("link"):
        name = link.get("name", "")
        if name not in links:
            continue
        where = f"{description.name}, link {name!r}"
        for element in link.findall("visual"):
            try:
                visuals = list(_geometries(element, _material(element, colours, where), folder, where))
            except FileNotFoundError as missing:
                notes.append(f"{where}: {missing}, left out")
                continue
            by_link.setdefault(name, []).extend(visual.placed(_origin(element, where)) for visual in visuals)
    return LinkVisuals(by_link, tuple(notes))


def _geometries(element: etree._Element, material: Material, folder: Path | None, where: str) -> Iterator[Visual]:
    """Geometries of a ``<visual>`` element, in its own frame."""
    geometry = element.find("geometry")
    for shape in () if geometry is None else geometry:
        if shape.tag == "box":
            yield box(_numbers(shape, "size", 3, where), material)
        elif shape.tag == "cylinder":
            radius, length = (_numbers(shape, name, 1, where)[0] for name in ("radius", "length"))
            yield cylinder(radius, length, material)
        elif shape.tag == "sphere":
            yield ellipsoid(_numbers(shape, "radius", 1, where)[0], material)
        elif shape.tag == "mesh":
            yield _mesh(shape, material, folder, where)


def _mesh(shape: etree._Element, material: Material, folder: Path | None, where: str) -> Visual:
    """Read a ``<mesh>``; raise FileNotFoundError if it is missing or not a mesh."""
    name = shape.get("filename", "")
    path, scale = find_mesh(name, folder), _numbers(shape, "scale", 3, where, "1 1 1")
    try:
        mesh = load_mesh(path, scale)
    except Exception as error:  # the reader of meshes raises errors of several kinds
        raise FileNotFoundError(f"mesh {name!r} cannot be read ({error})") from error
    return triangle_mesh(mesh.points, mesh.normals, mesh.triangles, material)


def _material(element: etree._Element, colours: dict[str, Material | None], where: str) -> Material:
    """Material of a ``<visual>`` element, or that of its name among the robot's materials."""
    material = element.find("material")
    if material is None:
        return Material(PLAIN)
    return _colour(material, where) or colours.get(material.get("name", "")) or Material(PLAIN)


def _colour(material: etree._Element, where: str) -> Material | None:
    """Material of a ``<color>`` element, or None."""
    colour = material.find("color")
    if colour is None:
        return None
    rgba = np.clip(_numbers(colour, "rgba", 4, where), 0.0, 1.0)
    red, green, blue = (round(255.0 * float(value)) for value in rgba[:3])
    return Material(f"#{red:02x}{green:02x}{blue:02x}", float(rgba[3]))


def _origin(element: etree._Element, where: str) -> FloatArray:
    """Transform of a ``<visual>`` element's ``<origin>``, (4, 4)."""
    origin = element.find("origin")
    if origin is None:
        return np.eye(4)
    rotation = pin.rpy.rpyToMatrix(_numbers(origin, "rpy", 3, where, "0 0 0"))
    return homogeneous(_numbers(origin, "xyz", 3, where, "0 0 0"), rotation)


def _numbers(element: etree._Element, attribute: str, count: int, where: str, default: str = "") -> FloatArray:
    """Read finite numbers from an attribute, (count,)."""
    text = element.get(attribute, default)
    try:
        values = np.array([float(word) for word in text.split()])
    except ValueError:
        values = np.empty(0)
    if len(values) != count or not np.isfinite(values).all():
        raise ExoidError(
            f"<{element.tag} {attribute}={text!r}> of a <visual> is not {count} finite number{'s' * (count > 1)}",
            where=where,
            remedy="write decimal numbers, separated by spaces",
        )
    return values
