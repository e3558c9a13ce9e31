"""What the links of a URDF look like: its <visual> elements as parts."""

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
from .parts import Look, Part, box, cylinder, ellipsoid, moved, surface

PLAIN = "#b8bcc2"
"""Colour of a link for which the URDF names none."""


class Visuals(NamedTuple):
    """How links look, and what could not be drawn.

    Attributes:
        parts: Of each link that has any, in the link's frame.
        notes: One sentence for each mesh that is missing.
    """

    parts: dict[str, list[Part]]
    notes: tuple[str, ...]


def read_visuals(description: Description, links: Sequence[str], folder: Path | None) -> Visuals:
    """Turn the <visual> elements of links into parts.

    Args:
        description: The URDF.
        links: Links wanted.
        folder: Where to look for meshes; see :func:`.meshes.find_mesh`.

    Raises:
        ExoidError: A number in a <visual> is none.
    """
    root = description.parse()
    colours = {m.get("name", ""): _colour(m, description.name) for m in root.findall("material")}
    parts: dict[str, list[Part]] = {}
    notes: list[str] = []
    for link in root.findall("link"):
        name = link.get("name", "")
        if name not in links:
            continue
        place = f"{description.name}, link {name!r}"
        for visual in link.findall("visual"):
            try:
                drawn = list(_parts(visual, _look(visual, colours, place), folder, place))
            except FileNotFoundError as missing:
                notes.append(f"{place}: {missing}, left out")
                continue
            parts.setdefault(name, []).extend(part.at(_origin(visual, place)) for part in drawn)
    return Visuals(parts, tuple(notes))


def _parts(visual: etree._Element, look: Look, folder: Path | None, place: str) -> Iterator[Part]:
    geometry = visual.find("geometry")
    for shape in () if geometry is None else geometry:
        if shape.tag == "box":
            yield box(_numbers(shape, "size", 3, place), look)
        elif shape.tag == "cylinder":
            yield cylinder(_numbers(shape, "radius", 1, place)[0], _numbers(shape, "length", 1, place)[0], look)
        elif shape.tag == "sphere":
            yield ellipsoid(_numbers(shape, "radius", 1, place)[0], look)
        elif shape.tag == "mesh":
            yield _mesh(shape, look, folder, place)


def _mesh(shape: etree._Element, look: Look, folder: Path | None, place: str) -> Part:
    name = shape.get("filename", "")
    path = find_mesh(name, folder)
    if path is None:
        raise FileNotFoundError(f"mesh {name!r} not found")
    try:
        mesh = load_mesh(path, _numbers(shape, "scale", 3, place, "1 1 1"))
    except Exception as error:  # whatever the reader of meshes throws
        raise FileNotFoundError(f"mesh {name!r} cannot be read ({error})") from error
    return surface(mesh.points, mesh.normals, mesh.triangles, look)


def _look(visual: etree._Element, colours: dict[str, Look | None], place: str) -> Look:
    material = visual.find("material")
    if material is None:
        return Look(PLAIN)
    return _colour(material, place) or colours.get(material.get("name", "")) or Look(PLAIN)


def _colour(material: etree._Element, place: str) -> Look | None:
    colour = material.find("color")
    if colour is None:
        return None
    rgba = np.clip(_numbers(colour, "rgba", 4, place), 0.0, 1.0)
    red, green, blue = (round(255.0 * float(value)) for value in rgba[:3])
    return Look(f"#{red:02x}{green:02x}{blue:02x}", float(rgba[3]))


def _origin(visual: etree._Element, place: str) -> FloatArray:
    origin = visual.find("origin")
    if origin is None:
        return np.eye(4)
    rotation = pin.rpy.rpyToMatrix(_numbers(origin, "rpy", 3, place, "0 0 0"))
    return moved(_numbers(origin, "xyz", 3, place, "0 0 0"), rotation)


def _numbers(element: etree._Element, attribute: str, count: int, place: str, default: str = "") -> FloatArray:
    text = element.get(attribute, default)
    try:
        values = np.array([float(word) for word in text.split()])
    except ValueError:
        values = np.empty(0)
    if len(values) != count or not np.isfinite(values).all():
        raise ExoidError(
            f"<{element.tag} {attribute}={text!r}> of a <visual> is not {count} finite number{'s' * (count > 1)}",
            where=place,
            remedy="write decimal numbers, parted by spaces",
        )
    return values
