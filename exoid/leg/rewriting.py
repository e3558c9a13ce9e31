"""Rewriting numbers in a URDF, and a rail before it; meshes, geometry, comments and unknown elements do not change."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pinocchio as pin
from lxml import etree

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.tools.numbers import checked

from .description import FARTHEST, Description, describe

INERTIA = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}

RAILS = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}
"""Directions in which a base can be free, as axes of a joint before it."""

RAIL = "rail"
"""Root link of a leg whose base is on a rail."""


def on_rail(description: Description, axis: str) -> Description:
    """Put the root link on a rail: a prismatic joint without limits."""
    root = description.parse()
    etree.SubElement(root, "link", name=RAIL)
    joint = etree.SubElement(root, "joint", name=f"base_{axis}", type="prismatic")
    etree.SubElement(joint, "parent", link=RAIL)
    etree.SubElement(joint, "child", link=description.root_link)
    etree.SubElement(joint, "axis", xyz=RAILS[axis])
    etree.SubElement(joint, "limit", lower="0", upper="0", effort="0", velocity="0")
    return describe(etree.tostring(root, encoding="unicode"), description.name)


def read_inertials(description: Description) -> dict[str, FloatArray]:
    """Read the inertia of each link."""
    found = {}
    for link in description.parse().findall("link"):
        inertial = link.find("inertial")
        if inertial is not None:
            found[link.get("name", "")] = _parameters(inertial)
    return found


def rewrite(
    description: Description,
    inertials: Mapping[str, FloatArray],
    dynamics: Mapping[str, Mapping[str, float]],
    note: str = "",
) -> str:
    """Change inertias and joint friction in a URDF."""
    root = description.parse()
    for link in root.findall("link"):
        if link.get("name") in inertials:
            _write_inertial(link, inertials[link.get("name", "")])
    for joint in root.findall("joint"):
        for attribute, value in dynamics.get(joint.get("name", ""), {}).items():
            _child(joint, "dynamics").set(attribute, repr(float(value)))
    above, below = reversed([*root.itersiblings(preceding=True)]), root.itersiblings()
    remark = [etree.Comment(f" {note.replace('--', '- -')} ")] if note else []
    parts = (etree.tostring(part, encoding="unicode", with_tail=False) for part in (*remark, *above, root, *below))
    return "\n".join(['<?xml version="1.0" encoding="utf-8"?>', *parts, ""])


def add_edges(description: Description, places: Mapping[str, Sequence[float]]) -> Description:
    """Add links ``<foot>_heel`` and ``<foot>_toe`` to a URDF, fixed to the foot at a place in its axes [m]."""
    root = description.parse()
    links = [link.get("name", "") for link in root.findall("link")]
    for edge, place in places.items():
        foot, _, part = edge.rpartition("_")
        if part not in ("heel", "toe") or foot not in links or edge in links:
            raise BadArgumentError(
                f"a place of {edge!r}, which is no heel or toe that can be added",
                where=description.name,
                remedy=f"name <foot>_heel or <foot>_toe of a link, which are {', '.join(links)}",
            )
        numbers = checked(np.asarray(place, dtype=np.float64), f"the place of {edge}", least=-FARTHEST, most=FARTHEST)
        if numbers.shape != (3,):
            raise BadArgumentError(f"the place of {edge} has shape {numbers.shape}", remedy="give (x, y, z) [m]")
        etree.SubElement(root, "link", name=edge)
        joint = etree.SubElement(root, "joint", name=f"{edge}_fixed", type="fixed")
        etree.SubElement(joint, "parent", link=foot)
        etree.SubElement(joint, "child", link=edge)
        etree.SubElement(joint, "origin", xyz=" ".join(repr(float(x)) for x in numbers))
    return describe(etree.tostring(root.getroottree(), encoding="unicode"), description.name)


def _parameters(inertial: etree._Element) -> FloatArray:
    origin, mass, inertia = (inertial.find(tag) for tag in ("origin", "mass", "inertia"))
    assert mass is not None
    assert inertia is not None
    rotation = pin.rpy.rpyToMatrix(numbers_of(origin, "rpy"))
    tensor = np.empty((3, 3))
    for name, (row, column) in INERTIA.items():
        tensor[row, column] = tensor[column, row] = float(inertia.get(name, "0"))
    body = pin.Inertia(float(mass.get("value", "0")), numbers_of(origin, "xyz"), rotation @ tensor @ rotation.T)
    return np.asarray(body.toDynamicParameters())


def numbers_of(element: etree._Element | None, attribute: str, default: str = "0 0 0") -> FloatArray:
    """Numbers of an attribute, which were checked before."""
    return np.array((default if element is None else element.get(attribute, default)).split(), dtype=np.float64)


def _write_inertial(link: etree._Element, parameters: FloatArray) -> None:
    mass, centre = float(parameters[0]), parameters[1:4] / parameters[0]
    xx, xy, yy, xz, yz, zz = parameters[4:]
    about_joint = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    tensor = about_joint - mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    inertial = _child(link, "inertial", first=True)
    origin = _child(inertial, "origin", first=True)
    origin.set("xyz", " ".join(repr(float(x)) for x in centre))
    origin.set("rpy", "0 0 0")
    _child(inertial, "mass").set("value", repr(mass))
    element = _child(inertial, "inertia")
    for name, (row, column) in INERTIA.items():
        element.set(name, repr(float(tensor[row, column])))


def _child(parent: etree._Element, tag: str, *, first: bool = False) -> etree._Element:
    """Find a child element, or make it with the white space of its neighbours."""
    if (found := parent.find(tag)) is not None:
        return found
    made = etree.Element(tag)
    if first or not len(parent):
        made.tail = parent.text
        parent.insert(0, made)
    else:
        last = parent[-1]
        made.tail, last.tail = last.tail, parent.text
        parent.append(made)
    return made
