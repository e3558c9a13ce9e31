"""Reading a URDF that may be malicious: size, encoding, entities and structure are checked before it is parsed."""

from __future__ import annotations

import hashlib
import math
import re
from collections import Counter
from collections.abc import Container, Mapping
from dataclasses import dataclass, field
from decimal import ROUND_DOWN, ROUND_HALF_EVEN, Decimal
from functools import cached_property
from pathlib import Path
from reprlib import repr as shortened

from lxml import etree

from exoid.errors import UnreadableInputError
from exoid.tools.files import read_bounded

LARGEST_URDF = 20_000_000
"""Largest size of a URDF [bytes]; those of humanoids are about a hundred times smaller."""

MOST_LINKS = 1000
"""Largest number of links. Humanoids with hands have about 150; thousands overflow the stack of Pinocchio's parser."""

JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")

LARGEST_NUMBER = 1e9
"""Largest number of an inertia, a place or friction in SI units; with larger ones arithmetic overflows."""

LARGEST_ANGLE = 2.0 * math.pi
"""Usual largest angle of a joint [rad]; larger ones are almost always degrees."""

FARTHEST = 5.0
"""Largest distance of a point from its joint or link [m]; larger ones are mm."""

LARGEST = {"limit": math.inf, "origin": 100.0, "inertia": 1e5}
"""Other limits of elements: large joint limits mean none, farther places are in mm, larger inertias in g·mm²."""

NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?", re.ASCII)
"""A decimal number. Each text matches in one way only, so that long ones take no longer than they are."""

NUMBERS: Mapping[str, Mapping[str, int]] = {
    "link/inertial/mass": {"value": 1},
    "link/inertial/inertia": dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), 1),
    "link/inertial/origin": {"xyz": 3, "rpy": 3},
    "joint/origin": {"xyz": 3, "rpy": 3},
    "joint/axis": {"xyz": 3},
    "joint/dynamics": {"damping": 1, "friction": 1},
    "joint/limit": {"lower": 1, "upper": 1, "effort": 1, "velocity": 1},
}
"""Number of values in each attribute. Pinocchio's parser drops a whole <inertial> if one of them is not a number."""

REQUIRED = ("mass", "inertia")
"""Elements that must have all of these attributes."""


@dataclass(frozen=True)
class Description:
    """URDF as text, with the name and hash that identify it in results."""

    text: str = field(repr=False)  # XML of the URDF
    name: str  # file name, for messages and reports
    sha256: str  # hash of the text, hexadecimal

    @cached_property
    def child_links(self) -> dict[str, str]:
        """Name of the link that each joint carries."""
        joints = self.parse().findall("joint")
        return {j.get("name", ""): c.get("link", "") for j in joints if (c := j.find("child")) is not None}

    @cached_property
    def root_link(self) -> str:
        """Name of the link that no joint carries."""
        carried = set(self.child_links.values())
        return next(name for link in self.parse().findall("link") if (name := link.get("name", "")) not in carried)

    @property
    def plain(self) -> str:
        """XML for Pinocchio: single spaces between numbers, as it drops elements with other white space."""
        # Angles of joints in few digits become exact. Shapes are left out, as the parser prints about unknown ones.
        root = self.parse()
        for link in root.findall("link"):
            for shape in [*link.findall("visual"), *link.findall("collision")]:
                link.remove(shape)
        for path, attributes in NUMBERS.items():
            for element in root.findall(path):
                for attribute in attributes.keys() & element.keys():
                    element.set(attribute, " ".join(element.get(attribute, "").split()))
        for origin in root.findall("joint/origin[@rpy]"):
            origin.set("rpy", " ".join(_exact_angle(word) for word in origin.get("rpy", "").split()))
        return etree.tostring(root, encoding="unicode")

    def parse(self) -> etree._Element:
        """Parse the text into a new tree, with comments, which the caller may change."""
        return etree.fromstring(self.text.encode(), _parser())


def _exact_angle(text: str) -> str:
    """Replace a rounded multiple of π/12, such as 1.5708, by the exact one."""
    # Few digits make parallel axes nearly parallel. That lets parameters act on the torques which those of the robot do
    # not act on, by a millionth of the others, and no recording determines them.
    number = Decimal(text)
    exponent = number.as_tuple().exponent
    assert isinstance(exponent, int)  # the number is finite
    if abs(number) > 7:
        return text
    # decimals from which on a rounded multiple stands for the exact one: 1.57 for π/2, 0.5236 for π/6
    for step, decimals in ((math.pi / 2.0, 2), (math.pi / 12.0, 4)):
        multiple = round(float(number) / step) * step
        if multiple and decimals <= -exponent <= 10:  # rounding beyond ten decimals has no effect
            digit = Decimal(1).scaleb(exponent)
            if number in [Decimal(multiple).quantize(digit, rounding) for rounding in (ROUND_HALF_EVEN, ROUND_DOWN)]:
                return repr(multiple)
    return text


def read_description(path: str | Path) -> Description:
    """Read a URDF file."""
    path = Path(path)
    remedy = "give the path of a URDF file without embedded meshes, or the name of a built-in leg ('bleex', 'cuhk')"
    content = read_bounded(path, LARGEST_URDF, remedy)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        what, remedy = f"not UTF-8 text (byte {error.start})", "save the URDF as UTF-8 XML"
        raise UnreadableInputError(what, file=str(path), remedy=remedy) from error
    return describe(text, name=path.name)


def describe(text: str, name: str = "URDF") -> Description:
    """Check URDF text: well-formed XML, no document type or entities, a ``<robot>`` whose joints make one tree."""
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise UnreadableInputError(
            "declares a document type or entities, which can expand without bound",
            file=name,
            remedy="remove the <!DOCTYPE ...> block and write the values out",
        )
    try:
        root = etree.fromstring(text.encode(), _parser())
    except (etree.XMLSyntaxError, ValueError) as error:
        raise UnreadableInputError(f"not well-formed XML ({error})", file=name, remedy="correct the XML") from error
    if root.tag != "robot":
        raise UnreadableInputError(
            f"the root element is <{root.tag}>, not <robot>", file=name, remedy="give a URDF file"
        )
    if any(element.prefix == "xacro" for element in root.iter()):
        raise UnreadableInputError(
            "contains xacro commands", file=name, remedy="expand it first: xacro leg.xacro > leg.urdf"
        )
    _check_structure(root, name)
    _check_inertias(root, name)
    check_numbers(root, NUMBERS, REQUIRED, name)
    _check_axes(root, name)
    return Description(text, name, hashlib.sha256(text.encode()).hexdigest())


def _check_structure(root: etree._Element, name: str) -> None:
    links = [link.get("name", "") for link in root.findall("link")]
    joints = [joint.get("name", "") for joint in root.findall("joint")]
    if max(len(links), len(joints)) > MOST_LINKS:
        raise UnreadableInputError(
            f"{len(links)} links and {len(joints)} joints: more than {MOST_LINKS}",
            file=name,
            remedy="give the URDF of one robot",
        )
    repeated = sorted(n for names in (links, joints) for n, count in Counter(names).items() if count > 1)
    if repeated:
        raise UnreadableInputError(f"names occur twice: {', '.join(repeated)}", file=name, remedy="rename one of each")
    if not joints:
        raise UnreadableInputError("has no joints", file=name, remedy="give the URDF of a leg with at least one joint")
    for joint in root.findall("joint"):
        place = f"{name}, joint {joint.get('name', '')!r}"
        if joint.get("type") not in JOINT_TYPES:
            raise UnreadableInputError(
                f"unknown type {joint.get('type')!r}", where=place, remedy=f"use one of {', '.join(JOINT_TYPES)}"
            )
        for role in ("parent", "child"):
            end = joint.find(role)
            link = None if end is None else end.get("link")
            if link not in links:
                raise UnreadableInputError(
                    f"its <{role}> {link!r} is not a link", where=place, remedy=f"links are {', '.join(links)}"
                )
    _check_tree(root, links, name)


def _check_tree(root: etree._Element, links: list[str], name: str) -> None:
    carried = Counter(child.get("link", "") for child in root.findall("joint/child"))
    shared = [link for link, count in carried.items() if count > 1]
    if shared:
        raise UnreadableInputError(
            f"link {shared[0]!r} is the child of {carried[shared[0]]} joints",
            file=name,
            remedy="a URDF is a tree: cut the loop",
        )
    roots = [link for link in links if link not in carried]
    if len(roots) != 1:
        found = "no link is the root" if not roots else f"links {', '.join(roots[:5])} are children of no joint"
        raise UnreadableInputError(found, file=name, remedy="join all links to one tree with one root")


def check_numbers(
    root: etree._Element, counts: Mapping[str, Mapping[str, int]], required: Container[str], name: str
) -> None:
    """Check that attributes are finite decimal numbers of plausible size."""
    for path, attributes in counts.items():
        for element in root.findall(path):
            for attribute, count in attributes.items():
                text = element.get(attribute)
                if text is None and element.tag not in required:
                    continue
                words = (text or "").split()
                said = f"<{element.tag} {attribute}={shortened(text)}>"
                if len(words) != count or not all(NUMBER.fullmatch(w) and math.isfinite(float(w)) for w in words):
                    raise UnreadableInputError(
                        f"{said} is not {count} finite number{'s' * (count > 1)}",
                        where=_place(element, name),
                        remedy="write decimal numbers, separated by spaces",
                    )
                if max(abs(float(word)) for word in words) > (limit := LARGEST.get(element.tag, LARGEST_NUMBER)):
                    raise UnreadableInputError(
                        f"{said} is not plausible (limit {limit:g}, SI)",
                        where=_place(element, name),
                        remedy="write lengths in m, angles in rad, masses in kg, inertias in kg·m²",
                    )


def _check_inertias(root: etree._Element, name: str) -> None:
    for inertial in root.findall("link/inertial"):
        if any(inertial.find(element) is None for element in REQUIRED):
            what, place = "its <inertial> lacks mass or inertia", _place(inertial, name)
            raise UnreadableInputError(what, where=place, remedy="write both, or neither")


def _check_axes(root: etree._Element, name: str) -> None:
    for joint in root.findall("joint"):
        axis = joint.find("axis")
        if axis is None or joint.get("type") in ("fixed", "floating"):
            continue
        xyz = axis.get("xyz")  # without it, the parser takes the axis as zero
        if xyz is None or math.hypot(*map(float, xyz.split())) < 1e-6:
            what = "its <axis> has no xyz" if xyz is None else "its <axis> is zero"
            raise UnreadableInputError(what, where=_place(axis, name), remedy="write a unit vector")


def _place(element: etree._Element, name: str) -> str:
    """Name the link or joint that an element belongs to."""
    while element.tag not in ("link", "joint") and (above := element.getparent()) is not None:
        element = above
    return f"{name}, {element.tag} {element.get('name', '')!r}"


def _parser() -> etree.XMLParser:
    return etree.XMLParser(encoding="utf-8", resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False)
