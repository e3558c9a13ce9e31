"""Machines with closed loops, of random proportions: a four-bar knee, a knee with a cylinder, an ankle on two rods."""

from pathlib import Path
from typing import NamedTuple

import mujoco
import numpy as np
from lxml import etree
from urdf_text import joint_text

from exoid import Leg
from exoid.leg.loops import Loops
from exoid.tools.toml import parse_toml


class Machine(NamedTuple):
    """A URDF, its loops, and the joints that motors drive."""

    urdf: str
    loops: str
    joints: tuple[str, ...]

    def leg(self, folder: Path, loops: str | None = None, **options: object) -> Leg:
        """Read the machine from files."""
        (folder / "leg.urdf").write_text(self.urdf)
        (folder / "loops.toml").write_text(loops or self.loops)
        return Leg.from_urdf(folder / "leg.urdf", loops=folder / "loops.toml", **options)


def link(name: str, rng: np.random.Generator, mass: float, length: float, *, planar: bool) -> str:
    """Write a link with a random inertia that hangs down from its frame."""
    mass *= rng.uniform(0.8, 1.25)
    x, y, z = length * rng.uniform((-0.2, -0.2, -0.6), (0.2, 0.2, -0.4)) * [1.0, not planar, 1.0]
    i = mass * length**2 / 12.0 * rng.uniform(0.8, 1.2, 3)
    return (
        f'<link name="{name}"><inertial><origin xyz="{x:.5f} {y:.5f} {z:.5f}"/><mass value="{mass:.5f}"/>'
        f'<inertia ixx="{i[0]:.7f}" ixy="0" ixz="0" iyy="{i[1]:.7f}" iyz="0" izz="{i[1] / 2:.7f}"/></inertial></link>'
    )


def joint(name: str, parent: str, child: str, xyz: np.ndarray, axis: str = "0 1 0", limit: float = 0.6) -> str:
    """Write a joint."""
    limits = (limit, 100.0, 10.0)
    return joint_text(name, "revolute", parent, child, np.round(xyz, 5), map(float, axis.split()), limits)


def near(rng: np.random.Generator, *place: float) -> np.ndarray:
    """Draw a point within 6 mm of a place."""
    return np.round(place + rng.uniform(-0.006, 0.006, 3), 5)


def end(link: str, xyz: np.ndarray) -> str:
    """Write one end of a loop."""
    return f'{{link = "{link}", xyz = [{", ".join(f"{x:.5f}" for x in xyz)}]}}'


def four_bar_knee(seed: int) -> Machine:
    """Hip, and a knee whose shank hangs on two links of the thigh; motors at the hip and the front link."""
    rng = np.random.default_rng(seed)
    # Pivots on the thigh, and on the shank in axes of the thigh at the zero pose
    a, b, c, d = np.array([[0.03, 0, -0.40], [-0.02, 0, -0.41], [-0.03, 0, -0.47], [0.03, 0, -0.46]])
    a, b, c, d = np.round(np.stack([a, b, c, d]) * [1, 0, 1] + rng.uniform(-0.006, 0.006, (4, 3)) * [1, 0, 1], 5)
    links = [
        '<link name="pelvis"/>',
        link("thigh", rng, 4.0, 0.42, planar=True),
        link("front", rng, 0.5, 0.09, planar=True),
        link("rear", rng, 0.4, 0.08, planar=True),
        link("shank", rng, 3.5, 0.45, planar=True),
    ]
    joints = [
        joint("hip", "pelvis", "thigh", np.zeros(3), limit=1.0),
        joint("knee", "thigh", "front", a),
        joint("front_pin", "front", "shank", c - a),
        joint("rear_pin", "thigh", "rear", b),
    ]
    loops = (
        'dependent = ["front_pin", "rear_pin"]\n[[loops]]\nname = "four-bar"\nkind = "pin"\naxis = [0, 1, 0]\n'
        f"first = {end('rear', d - b)}\nsecond = {end('shank', d - c)}\n"
    )
    return Machine(f'<robot name="four-bar">{"".join([*links, *joints])}</robot>', loops, ("hip", "knee"))


def two_rod_ankle(seed: int) -> Machine:
    """Ankle of two axes that two cranks on the shank move by rods with a universal joint and a ball."""
    rng = np.random.default_rng(seed)
    links = ['<link name="shank"/>', link("cross", rng, 0.15, 0.05, planar=False)]
    links.append(link("foot", rng, 1.6, 0.2, planar=False))
    ankle = near(rng, 0.0, 0.0, -0.35)
    joints = [joint("pitch", "shank", "cross", ankle), joint("roll", "cross", "foot", np.zeros(3), "1 0 0", 0.4)]
    loops, dependent = [], ["pitch", "roll"]
    for side, y in (("left", 0.045), ("right", -0.045)):
        motor = near(rng, 0.0, y, -0.08)
        arm = near(rng, -0.06, 0.0, 0.0)
        ball = np.round(ankle + near(rng, -0.065, y, -0.02), 5)
        rod = ball - motor - arm
        links += [
            link(f"crank_{side}", rng, 0.5, 0.06, planar=False),
            link(f"knuckle_{side}", rng, 0.1, 0.03, planar=False),
            link(f"rod_{side}", rng, 0.4, 0.26, planar=False),
        ]
        joints += [
            joint(f"motor_{side}", "shank", f"crank_{side}", motor),
            joint(f"swing_{side}", f"crank_{side}", f"knuckle_{side}", arm),
            joint(f"tilt_{side}", f"knuckle_{side}", f"rod_{side}", np.zeros(3), "1 0 0"),
        ]
        dependent += [f"swing_{side}", f"tilt_{side}"]
        loops.append(
            f'[[loops]]\nname = "rod {side}"\nkind = "ball"\nfirst = {end(f"rod_{side}", rod)}\n'
            f"second = {end('foot', ball - ankle)}\n"
        )
    named = ", ".join(f'"{name}"' for name in dependent)
    text = f"dependent = [{named}]\n{''.join(loops)}"
    return Machine(f'<robot name="ankle">{"".join([*links, *joints])}</robot>', text, ("motor_left", "motor_right"))


def cylinder_knee(seed: int, horn: float = 1.0, limit: float = 0.05) -> Machine:
    """Knee that a linear actuator behind the thigh moves by a horn; its motor is the sliding joint."""
    rng = np.random.default_rng(seed)
    points = near(rng, 0.0, 0.0, -0.42), near(rng, -0.05, 0.0, -0.08), near(rng, -0.06, 0.0, -0.03)
    knee, above, below = np.round(np.array(points) * [1.0, 0.0, 1.0] * [[1.0], [1.0], [horn]], 5)
    links = [
        '<link name="thigh"/>',
        link("shank", rng, 3.5, 0.42, planar=True),
        link("barrel", rng, 0.8, 0.2, planar=True),
        link("rod", rng, 0.4, 0.2, planar=True),
    ]
    stroke = joint("cylinder", "barrel", "rod", np.array([0.0, 0.0, -0.2]), "0 0 -1", limit)
    joints = [
        joint("knee", "thigh", "shank", knee, limit=1.0),
        joint("pivot", "thigh", "barrel", above, limit=1.0),
        stroke.replace("revolute", "prismatic"),
    ]
    loops = (
        'dependent = ["knee", "pivot"]\n[start]\npivot = 0.1\n[[loops]]\nname = "cylinder"\nkind = "pin"\n'
        f"first = {end('rod', np.array([0.0, 0.0, -0.15]))}\nsecond = {end('shank', below)}\n"
    )
    return Machine(f'<robot name="cylinder">{"".join([*links, *joints])}</robot>', loops, ("cylinder",))


def welded_knee(seed: int) -> Machine:
    """Four-bar knee as a chain whose last link, a stub, is welded to the thigh."""
    machine, rng = four_bar_knee(seed), np.random.default_rng(seed)
    loop = parse_toml(machine.loops)["loops"][0]
    root = etree.fromstring(machine.urdf)
    (pivot,) = (each for each in root.iter("joint") if each.get("name") == "rear_pin")
    place = np.array(pivot.find("origin").get("xyz").split(), float)
    up = -np.array(loop["first"]["xyz"])
    pivot.find("parent").set("link", "shank")
    pivot.find("origin").set("xyz", " ".join(map(str, loop["second"]["xyz"])))
    root.append(etree.fromstring(link("stub", rng, 0.05, 0.02, planar=True)))
    root.append(etree.fromstring(joint("stub_pin", "rear", "stub", up)))
    loops = (
        'dependent = ["front_pin", "rear_pin", "stub_pin"]\n[[loops]]\nname = "stub"\nkind = "weld"\n'
        f"first = {end('thigh', place)}\nsecond = {end('stub', np.zeros(3))}\n"
    )
    return Machine(etree.tostring(root).decode(), loops, machine.joints)


def to_mjcf(machine: Machine, *, sites: bool = True) -> mujoco.MjSpec:
    """The machine in MuJoCo, with motors; its loops are `connect` of sites or bodies, or `weld`."""
    root = etree.fromstring(machine.urdf)
    etree.SubElement(etree.SubElement(root, "mujoco"), "compiler", fusestatic="false")
    spec = mujoco.MjSpec.from_string(etree.tostring(root).decode())
    for loop in Loops.from_data(parse_toml(machine.loops)).loops:
        ends, weld = (loop.first, loop.second), loop.kind == "weld"
        kind = mujoco.mjtEq.mjEQ_WELD if weld else mujoco.mjtEq.mjEQ_CONNECT
        names = [end.link for end in ends] if weld or not sites else [f"{loop.name} {end.link}" for end in ends]
        by = mujoco.mjtObj.mjOBJ_BODY if weld or not sites else mujoco.mjtObj.mjOBJ_SITE
        equality = spec.add_equality(type=kind, objtype=by, name=loop.name, name1=names[0], name2=names[1])
        if weld:
            equality.data[:10] = [*loop.second.xyz, *loop.first.xyz, 1.0, 0.0, 0.0, 0.0]
        elif not sites:
            equality.data[:3] = loop.first.xyz
        else:
            for end, name in zip(ends, names, strict=True):
                spec.body(end.link).add_site(name=name, pos=end.xyz)
    for name in machine.joints:
        spec.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT).set_to_motor()
    return spec
