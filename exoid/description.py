"""Reading a URDF that may be hostile: size, encoding, entities and structure are checked before a parser acts on it."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from lxml import etree

from .errors import ExoidError

LARGEST_URDF = 20_000_000
"""Bytes; the largest URDFs of humanoids are about a hundred times smaller."""

JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")


@dataclass(frozen=True)
class Description:
    """A URDF as text, with the name and hash that identify it in results.

    Attributes:
        text: The XML.
        name: File name, for messages and reports.
        sha256: Hash of the text, hexadecimal.
    """

    text: str
    name: str
    sha256: str

    @cached_property
    def child_links(self) -> dict[str, str]:
        """Name of the link that each joint carries."""
        root = etree.fromstring(self.text.encode(), _parser())
        return {
            joint.get("name", ""): child.get("link", "")
            for joint in root.findall("joint")
            if (child := joint.find("child")) is not None
        }


def read_description(path: str | Path) -> Description:
    """Read a URDF file.

    Args:
        path: The file.

    Returns:
        The checked description.

    Raises:
        ExoidError: The file cannot be read, or is not a plain URDF (see :func:`describe`).
    """
    path = Path(path)
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST_URDF + 1)
    except OSError as error:
        raise ExoidError(
            f"the URDF cannot be read ({error.strerror or error})",
            where=str(path),
            remedy="give the path of a readable URDF file, or the name of a built-in leg ('bleex', 'cuhk')",
        ) from error
    if len(content) > LARGEST_URDF:
        raise ExoidError(
            f"larger than {LARGEST_URDF / 1e6:.0f} MB, which no URDF needs",
            where=str(path),
            remedy="refer to meshes by file name instead of embedding them",
        )
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ExoidError(
            f"not UTF-8 text (byte {error.start})", where=str(path), remedy="save the URDF as UTF-8 XML"
        ) from error
    return describe(text, name=path.name)


def describe(text: str, name: str = "URDF") -> Description:
    """Check URDF text: well-formed XML, no document type or entities, a ``<robot>`` with joints.

    Args:
        text: The XML.
        name: What messages call it.

    Raises:
        ExoidError: Any of these does not hold.
    """
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise ExoidError(
            "declares a document type or entities, which can expand without bound",
            where=name,
            remedy="remove the <!DOCTYPE ...> block and write the values out",
        )
    try:
        root = etree.fromstring(text.encode(), _parser())
    except (etree.XMLSyntaxError, ValueError) as error:
        raise ExoidError(f"not well-formed XML ({error})", where=name, remedy="mend the XML") from error
    if root.tag != "robot":
        raise ExoidError(f"the root element is <{root.tag}>, not <robot>", where=name, remedy="give a URDF file")
    if any(prefix == "xacro" for prefix in root.nsmap) and root.findall(".//{*}macro"):
        raise ExoidError("contains xacro macros", where=name, remedy="expand it first: xacro leg.xacro > leg.urdf")
    _check_structure(root, name)
    return Description(text, name, hashlib.sha256(text.encode()).hexdigest())


def _check_structure(root: etree._Element, name: str) -> None:
    links = [link.get("name", "") for link in root.findall("link")]
    joints = [joint.get("name", "") for joint in root.findall("joint")]
    repeated = sorted({n for names in (links, joints) for n in names if names.count(n) > 1})
    if repeated:
        raise ExoidError(f"names occur twice: {', '.join(repeated)}", where=name, remedy="rename one of each")
    if not joints:
        raise ExoidError("has no joints", where=name, remedy="give the URDF of a leg with at least one joint")
    for joint in root.findall("joint"):
        place = f"{name}, joint {joint.get('name', '')!r}"
        if joint.get("type") not in JOINT_TYPES:
            raise ExoidError(
                f"unknown type {joint.get('type')!r}", where=place, remedy=f"use one of {', '.join(JOINT_TYPES)}"
            )
        for role in ("parent", "child"):
            end = joint.find(role)
            link = None if end is None else end.get("link")
            if link not in links:
                raise ExoidError(
                    f"its <{role}> {link!r} is not a link", where=place, remedy=f"links are {', '.join(links)}"
                )


def _parser() -> etree.XMLParser:
    return etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False)
