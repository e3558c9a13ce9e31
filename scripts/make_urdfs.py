"""Write the URDFs in urdf/ from the published tables and the assumptions in exoid/leg/published/*.toml.

python scripts/make_urdfs.py            writes them
python scripts/make_urdfs.py --check    changes nothing; exit status 1 when a file differs

Frames: x forward, y left, z up; at the zero pose the leg hangs straight down, all link frames are parallel.
Inertial numbers and limits are written so that reading them gives the same double; what is only looked at
(urdf_looks.py) is rounded.
"""

from __future__ import annotations

import argparse
import math
import sys
import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import urdf_looks as looks
from urdf_looks import SIDES, Vector, Visual

from exoid import published

URDF_FOLDER = Path(__file__).resolve().parent.parent / "urdf"

FORWARD, BACKWARD = (0.0, -1.0, 0.0), (0.0, 1.0, 0.0)
"""Axis of a joint whose positive angle swings the link below it forward, or backward."""


@dataclass(frozen=True)
class Inertial:
    """Mass [kg], centre of mass in the link frame [m], principal inertia about it (Ixx, Iyy, Izz) [kg·m²]."""

    mass: float
    com: Vector
    inertia: Vector


@dataclass(frozen=True)
class Link:
    """A link and how it looks."""

    name: str
    inertial: Inertial
    visuals: Sequence[Visual]


@dataclass(frozen=True)
class Joint:
    """A revolute joint; limits in rad, N·m, rad/s; viscous [N·m·s/rad] and Coulomb friction [N·m]."""

    name: str
    parent: str
    child: str
    xyz: Vector
    axis: Vector
    lower: float
    upper: float
    effort: float
    velocity: float
    viscous: float
    coulomb: float


@dataclass(frozen=True)
class Robot:
    """Everything that one URDF says."""

    name: str
    comment: str
    colours: Mapping[str, str]
    links: Sequence[Link]
    joints: Sequence[Joint]


# ---------------------------------------------------------------------------------- inertial numbers


def segments(
    parameters: Mapping[str, float],
    masses: Sequence[float],
    lengths: Sequence[float],
    shapes: Sequence[tuple[float, float]],
    *,
    cumulative: bool,
) -> list[Inertial]:
    """Find centre of mass and inertia of every segment from X, Y, J.

    Inverts doc. 1, eqs. (1)-(9), or doc. 2, Table I with J_t in J1. With M the mass below and L the length:
    c_x = Y/m,  c_z = −(X − M L)/m,  I_yy = J [− J below, if cumulative] − m |c|² − M L².

    Args:
        parameters: X1, Y1, J1, X2, …
        masses: Of the segments from the hip down [kg].
        lengths: From each joint to the next [m]; one less than there are masses.
        shapes: Ixx/Iyy and Izz/Iyy of each segment.
        cumulative: Whether J contains the J below it.
    """
    inertials = []
    for i, (m, shape) in enumerate(zip(masses, shapes, strict=True), start=1):
        below, length = math.fsum(masses[i:]), [*lengths, 0.0][i - 1]
        c_x = parameters[f"Y{i}"] / m
        c_z = -(parameters[f"X{i}"] - below * length) / m
        own = parameters[f"J{i}"] - (parameters.get(f"J{i + 1}", 0.0) if cumulative else 0.0)
        i_yy = own - m * (c_x * c_x + c_z * c_z) - below * length * length
        inertials.append(Inertial(m, (c_x, 0.0, c_z), (shape[0] * i_yy, i_yy, shape[1] * i_yy)))
    return inertials


def cuboid(mass: float, size: Vector, com: Vector) -> Inertial:
    """Inertial of a uniform box."""
    xx, yy, zz = (a * a for a in size)
    return Inertial(mass, com, (mass * (yy + zz) / 12, mass * (xx + zz) / 12, mass * (xx + yy) / 12))


# -------------------------------------------------------------------------------------------- robots

Leg = Sequence[tuple[str, str, Vector, Vector]]
"""From the hip down: joint, the link below it, place of the joint in the link above [m], axis."""


def leg_joints(
    side: str, leg: Leg, assumed: Mapping[str, float], friction: Mapping[str, tuple[float, float]]
) -> list[Joint]:
    """Joints of one leg, with the assumed limits and the (viscous, Coulomb) friction of their names."""
    joints, parent = [], "torso"
    for name, child, xyz, axis in leg:
        lower, upper = (math.radians(assumed[f"{name}_{end}"]) for end in ("lower", "upper"))
        limits = (lower, upper, assumed[f"{name}_effort"], assumed[f"{name}_velocity"])
        joints.append(Joint(f"{side}_{name}", parent, f"{side}_{child}", xyz, axis, *limits, *friction[name]))
        parent = f"{side}_{child}"
    return joints


def leg_links(side: str, inertials: Sequence[Inertial], drawn: Mapping[str, list[Visual]]) -> list[Link]:
    """Links of one leg, from the thigh down."""
    return [Link(f"{side}_{part}", i, drawn[part]) for part, i in zip(drawn, inertials, strict=True)]


def bleex(name: str, sets: Mapping[str, str], comment: str) -> Robot:
    """BLEEX with a parameter set ("cad", "left" or "right") for each side."""
    assumed = values(published.bleex())
    width, l_t, l_s = assumed["hip_half_width"], assumed["L_t"], assumed["L_s"]
    masses = (assumed["m_t"], assumed["m_s"], assumed["m_f"])
    shapes = [ratios(assumed, "limb"), ratios(assumed, "limb"), ratios(assumed, "foot")]
    torso = cuboid(assumed["m_torso"], (0.30, 0.45, 0.60), (-0.20, 0, 0.30))
    links = [Link("torso", torso, looks.bleex_torso(width))]
    joints: list[Joint] = []
    for side, sign in SIDES.items():
        parameters, resistances = published.bleex_parameters(sets[side]), published.bleex_resistances(side)
        inertials = segments(parameters, masses, (l_t, l_s), shapes, cumulative=True)
        links += leg_links(side, inertials, looks.bleex_visuals(sign, l_t, l_s))
        leg = [
            ("hip", "thigh", (0.0, sign * width, 0.0), FORWARD),
            ("knee", "shank", (0.0, 0.0, -l_t), FORWARD),
            ("ankle", "foot", (0.0, 0.0, -l_s), FORWARD),
        ]
        friction = {joint: (0.0, resistances.get(f"c0_{joint}", 0.0)) for joint in ("hip", "knee", "ankle")}
        joints += leg_joints(side, leg, assumed, friction)
    comment = f"{comment}\n{BLEEX_COMMENT}\n{listed(published.bleex())}"
    return Robot(name, comment, looks.BLEEX_COLOURS, links, joints)


def cuhk() -> Robot:
    """CUHK-EXO: the assumed plant on both sides, the foot a part of the shank."""
    assumed, resistances = values(published.cuhk()), published.cuhk_resistances()
    width, l_t, l_s = assumed["hip_half_width"], assumed["L_t"], assumed["L_s"]
    masses, shapes = (assumed["m_t"], assumed["m_s"]), [ratios(assumed, "limb")] * 2
    inertials = segments(published.cuhk_parameters(), masses, (l_t,), shapes, cumulative=False)
    friction = {joint: (resistances[f"d_{joint}"], resistances[f"c0_{joint}"]) for joint in ("hip", "knee")}
    torso = cuboid(assumed["m_torso"], (0.20, 0.45, 0.50), (-0.15, 0, 0.20))
    links = [Link("torso", torso, looks.cuhk_torso(width))]
    joints: list[Joint] = []
    for side, sign in SIDES.items():
        links += leg_links(side, inertials, looks.cuhk_visuals(sign, l_t, l_s))
        leg = [
            ("hip", "thigh", (0.0, sign * width, 0.0), FORWARD),
            ("knee", "shank", (0.0, 0.0, -l_t), BACKWARD),
        ]
        joints += leg_joints(side, leg, assumed, friction)
    comment = f"{CUHK_COMMENT}\n{listed(published.cuhk())}"
    return Robot("cuhk_exo", comment, looks.CUHK_COLOURS, links, joints)


def dfki() -> Robot:
    """The DFKI double pendulum, design A.0, with its published model 1.0."""
    # mass [kg], distance of its centre from the joint [m], inertia about the joint [kg·m²]
    model = {"upper_link": (0.608, 0.275, 0.05472), "lower_link": (0.630, 0.166, 0.02522)}
    drawn = looks.dfki_visuals(0.3, 0.2)
    links = [Link("base", cuboid(2.0, (0.16, 0.07, 0.16), (0, 0.09, 0)), looks.dfki_base())]
    for name, (m, r, i_joint) in model.items():
        i_yy = i_joint - m * r * r
        links.append(Link(name, Inertial(m, (0.0, 0.0, -r), (0.97 * i_yy, i_yy, 0.12 * i_yy)), drawn[name]))
    limits = (-2 * math.pi, 2 * math.pi, 10.0, 20.0)
    friction = ((0.081, 0.093 * math.pi / 2), (0.0, 0.186 * math.pi / 2))
    joints = [
        Joint("shoulder", "base", "upper_link", (0.0, 0.0, 0.0), FORWARD, *limits, *friction[0]),
        Joint("elbow", "upper_link", "lower_link", (0.0, 0.0, -0.3), FORWARD, *limits, *friction[1]),
    ]
    return Robot("dfki_double_pendulum", DFKI_COMMENT, looks.DFKI_COLOURS, links, joints)


def values(document: published.Document) -> dict[str, float]:
    """The assumed numbers of a document by name."""
    return {name: assumption.value for name, assumption in document.assumptions.items()}


def ratios(assumed: Mapping[str, float], kind: str) -> tuple[float, float]:
    """The assumed ratios Ixx/Iyy and Izz/Iyy of a limb or a foot."""
    return assumed[f"{kind}_Ixx_over_Iyy"], assumed[f"{kind}_Izz_over_Iyy"]


def robots() -> dict[str, Robot]:
    """Every robot by the name of its file."""
    both_cad, own = {"left": "cad", "right": "cad"}, {"left": "left", "right": "right"}
    table_v = "BLEEX: inertias of the design models (Table V), the same for both legs."
    identified = "BLEEX: inertias identified on each leg (Tables II and III)."
    return {
        "bleex.urdf": bleex("bleex", both_cad, table_v),
        "bleex_identified.urdf": bleex("bleex_identified", own, identified),
        "cuhk.urdf": cuhk(),
        "dfki_double_pendulum.urdf": dfki(),
    }


# ------------------------------------------------------------------------------------------ comments

BLEEX_COMMENT = """\
Dry friction: Table IV of the same leg; none at the hip, where the document did not identify it.
The stiffness torques of Table I have no place in a URDF."""

CUHK_COMMENT = """\
CUHK-EXO with a wearer-sized payload. Both legs are the assumed plant, because the document publishes no
physical leg (its Table III has the shank's centre of mass above the knee). The passive foot belongs to the
shank. Knee stiffness and rotor inertia have no place in a URDF."""

DFKI_COMMENT = """\
DFKI double pendulum, design A.0: the published model 1.0 of
github.com/dfki-ric-underactuated-lab/double_pendulum (BSD-3-Clause).
Published: link lengths 0.3 and 0.2 m, mass m = 0.608 and 0.630 kg, centre of mass at r = 0.275 and 0.166 m,
inertia about the joint I = 0.05472 and 0.02522 kg·m² (in this file about the centre of mass: I - m r²),
torque limit 10 N·m.
Friction law there: b v + cf arctan(100 v) with b = 0.081 and 0 N·m·s/rad, cf = 0.093 and 0.186 N·m, without a
factor 2/pi; the dry friction in this file is its limit cf pi/2.
Rotor inertia there: 6.0719e-5 kg·m² at a gear ratio of 6; it has no place in a URDF.
Assumed: the joints turn without end, for which limits of ±2 pi and 20 rad/s stand; Ixx = 0.97 Iyy and
Izz = 0.12 Iyy (no effect in the plane); mass and inertia of the base, which does not move."""


def listed(document: published.Document) -> str:
    """Return the assumptions of a document, one in a line."""
    lines = (
        f"  {n} = {a.value!r} {a.unit}".removesuffix(" 1") + f": {a.reason}" for n, a in document.assumptions.items()
    )
    return f"Not in the document, assumed ({document.name}, {document.robot}):\n" + "\n".join(lines)


# ----------------------------------------------------------------------------------------------- XML


def number(value: float) -> str:
    """The shortest text that reads back as the same double, without a negative zero."""
    return repr(float(value) + 0.0)


def numbers(values: Sequence[float], digits: int | None = None) -> str:
    """Several of them, rounded when only looked at."""
    return " ".join(number(v if digits is None else round(v, digits)) for v in values)


def add_link(root: ET.Element, link: Link) -> None:
    """Append a link: inertial, then what is drawn."""
    element = ET.SubElement(root, "link", name=link.name)
    inertial = ET.SubElement(element, "inertial")
    ET.SubElement(inertial, "origin", xyz=numbers(link.inertial.com), rpy="0 0 0")
    ET.SubElement(inertial, "mass", value=number(link.inertial.mass))
    xx, yy, zz = (number(i) for i in link.inertial.inertia)
    ET.SubElement(inertial, "inertia", ixx=xx, ixy="0", ixz="0", iyy=yy, iyz="0", izz=zz)
    for visual in link.visuals:
        drawn = ET.SubElement(element, "visual")
        ET.SubElement(drawn, "origin", xyz=numbers(visual.xyz, 5), rpy=numbers(visual.rpy, 5))
        ET.SubElement(ET.SubElement(drawn, "geometry"), visual.shape, shape_attributes(visual))
        ET.SubElement(drawn, "material", name=visual.material)


def shape_attributes(visual: Visual) -> dict[str, str]:
    """Size of a primitive in URDF's words: a box has three in one attribute."""
    if visual.shape == "box":
        return {"size": numbers(visual.size, 5)}
    names = ("radius", "length")[: len(visual.size)]
    return {name: numbers([size], 5) for name, size in zip(names, visual.size, strict=True)}


def add_joint(root: ET.Element, j: Joint) -> None:
    """Append a revolute joint."""
    element = ET.SubElement(root, "joint", name=j.name, type="revolute")
    ET.SubElement(element, "parent", link=j.parent)
    ET.SubElement(element, "child", link=j.child)
    ET.SubElement(element, "origin", xyz=numbers(j.xyz), rpy="0 0 0")
    ET.SubElement(element, "axis", xyz=numbers(j.axis))
    limit = {"lower": j.lower, "upper": j.upper, "effort": j.effort, "velocity": j.velocity}
    ET.SubElement(element, "limit", {key: number(value) for key, value in limit.items()})
    ET.SubElement(element, "dynamics", damping=number(j.viscous), friction=number(j.coulomb))


def urdf(robot: Robot) -> str:
    """A robot as the text of its file."""
    root = ET.Element("robot", name=robot.name)
    for name, rgba in robot.colours.items():
        ET.SubElement(ET.SubElement(root, "material", name=name), "color", rgba=rgba)
    for link in robot.links:
        add_link(root, link)
    for j in robot.joints:
        add_joint(root, j)
    ET.indent(root)
    head = '<?xml version="1.0" encoding="utf-8"?>\n<!-- Written by scripts/make_urdfs.py: do not edit.\n\n'
    return f"{head}{robot.comment}\n-->\n{ET.tostring(root, encoding='unicode')}\n"


def main() -> int:
    """Write the files, or compare them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="write nothing; exit with 1 when a file differs")
    check = parser.parse_args().check
    texts = {URDF_FOLDER / name: urdf(robot).encode() for name, robot in robots().items()}
    different = [path for path, text in texts.items() if not path.exists() or path.read_bytes() != text]
    for path in different:
        if not check:
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(texts[path])
        print(f"{path.name}: {'differs' if check else 'written'}")
    return int(check and bool(different))


if __name__ == "__main__":
    sys.exit(main())
