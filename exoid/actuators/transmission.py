"""Gear ratios of ``<transmission>`` in a URDF."""

from __future__ import annotations

from typing import NamedTuple

from lxml import etree

from exoid.errors import UnreadableInputError
from exoid.leg.description import Description

from .motor import Motor


class Transmission(NamedTuple):
    """Gear between one motor and one joint, as a URDF describes it."""

    joint: str  # name of the joint
    ratio: float | None = None  # motor angle per joint angle, `<mechanicalReduction>`; None where it is not written
    efficiency: float | None = None  # efficiency of the gear, `<efficiency>`; None where it is not written

    def motor(self, torque_constant: float | None) -> Motor:
        """Make the motor of the transmission."""
        ratio = 1.0 if self.ratio is None else self.ratio
        return Motor(torque_constant, ratio=ratio, efficiency=1.0 if self.efficiency is None else self.efficiency)


def read_transmissions(description: Description) -> dict[str, Transmission]:
    """Read the transmissions of one joint in a URDF; those of several joints, such as differentials, are left out."""
    found: dict[str, Transmission] = {}
    for element in description.parse().iterchildren("transmission"):
        where = f"{description.name}, transmission {element.get('name', '')!r}"
        joints = [str(child.get("name", "")) for child in element.iterchildren("joint")]
        if len(joints) != 1:
            continue
        if joints[0] not in description.child_links:
            raise UnreadableInputError(f"no joint {joints[0]!r}", where=where, remedy="name a joint of the URDF")
        if joints[0] in found:
            raise UnreadableInputError(
                f"two transmissions of joint {joints[0]!r}", where=description.name, remedy="describe it once"
            )
        ratio, efficiency = (_number(element, tag, where) for tag in ("mechanicalReduction", "efficiency"))
        found[joints[0]] = Transmission(joints[0], ratio, efficiency)
    return found


def _number(element: etree._Element, tag: str, where: str) -> float | None:
    """Number of the only element of a name; None where there is none."""
    texts = [str(child.text or "") for child in element.iter(tag)]
    if not texts:
        return None
    try:
        (text,) = set(texts)  # older files repeat it at joint and actuator
        return float(text)
    except ValueError:
        raise UnreadableInputError(f"{tag} is {', '.join(texts)}", where=where, remedy="write one number") from None
