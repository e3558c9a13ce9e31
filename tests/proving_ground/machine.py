"""Machines drawn by seed: rigid bodies, joints and drives, as URDF for exoid and as MJCF for MuJoCo."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from urdf_text import joint_text, link_text, row

import exoid
from exoid.torques import Term

from .friction import OF_C0, Array, Friction, draw_friction
from .motion import pairs

GRAVITY = 9.81
COLOURS = ("white", "coloured", "speed-dependent")
TORQUES = ("sensor", "current", "command")
CONTROLLERS = ("pd", "gravity", "feedforward")
RATES = (50, 100, 200, 250, 500, 1000, 2000)


@dataclass(frozen=True, eq=False)
class Body:
    """Mass [kg], centre of mass in the axes of its link [m], and inertia about it [kg·m²]."""

    mass: float
    centre: Array
    inertia: Array


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint with what drives it.

    Attributes:
        name: Name.
        axis: Axis in the axes of the parent link, (3,).
        offset: Place in the parent link [m], (3,).
        friction: Friction.
        rotor: Inertia of the rotor, seen at the joint [kg·m²].
        spring: Stiffness between rotor and link [N·m/rad]; 0 if rigid.
        passive: Whether nothing drives it.
        slides: Whether it is prismatic, in m, N and kg.
        limit: Largest torque of the drive [N·m].
    """

    name: str
    axis: Array
    offset: Array
    friction: Friction
    rotor: float
    spring: float = 0.0
    passive: bool = False
    slides: bool = False
    limit: float = np.inf


@dataclass(frozen=True)
class Sensing:
    """What the log makes of the motion.

    Attributes:
        rate: Samples a second [Hz].
        torque: "sensor" (behind the gear: no rotor, and what a bearing keeps of the friction), "current" (at the drive)
            or "command" (before the current loop).
        noise: Standard deviation of the torque, in parts of that of the true torque.
        colour: "white", "coloured" or "speed-dependent".
        bits: Resolution of the encoders, for one turn.
        delay: By how much the torque is later than the angles [s].
        lag: Time constant of the current loop [s], which a command does not see.
    """

    rate: int
    torque: str
    noise: float
    colour: str
    bits: int
    delay: float
    lag: float = 0.001


@dataclass(frozen=True, eq=False)
class Machine:
    """One machine, its truth included.

    Attributes:
        seed: What it was drawn by.
        planar: Whether all axes are parallel.
        floating: Whether the root link moves, held by a load cell.
        root: Body of the root link.
        bodies: Body of each link.
        believed: Bodies of each link as the CAD has them, the root first.
        joints: Joints, from the root outwards.
        tool: Body that a fixed joint carries at the end of the last link; None without.
        end: Place of the tool in the last link [m].
        controller: Name of the controller.
        motions: Kinds of motion to learn from and to be judged on.
        sensing: What the log makes of the motion.
    """

    seed: int
    planar: bool
    floating: bool
    root: Body
    bodies: tuple[Body, ...]
    believed: tuple[Body, ...]
    joints: tuple[Joint, ...]
    tool: Body | None
    end: Array
    controller: str
    motions: tuple[str, str]
    sensing: Sensing

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the joints."""
        return tuple(joint.name for joint in self.joints)

    @property
    def mass(self) -> float:
        """Mass without the root [kg]."""
        return sum(body.mass for body in self.bodies) + (self.tool.mass if self.tool else 0.0)

    def urdf(self, *, believed: bool = False) -> str:
        """URDF with the true bodies, or with those of the CAD."""
        root, *bodies = self.believed if believed else (self.root, *self.bodies)
        parts, parent = [link_text("root", root)], "root"
        for joint, body in zip(self.joints, bodies, strict=True):
            kind, link = "prismatic" if joint.slides else "revolute", f"link_{joint.name}"
            parts.append(link_text(link, body))
            parts.append(joint_text(joint.name, kind, parent, link, joint.offset, joint.axis, (3.1, 1e4, 20.0)))
            parent = link
        if self.tool is not None:
            parts += [link_text("tool", self.tool), joint_text("mount", "fixed", parent, "tool", self.end)]
        return "<robot name='drawn'>\n" + "\n".join(parts) + "\n</robot>\n"

    def mjcf(self, *, believed: bool = False) -> str:
        """MuJoCo's model; the rotor behind a spring is a joint of its own, on a body without weight."""
        root, *bodies = self.believed if believed else (self.root, *self.bodies)
        tool = "" if self.tool is None else f'<body name="tool" pos="{row(self.end)}">{_inertial(self.tool)}</body>'
        tree = tool
        for joint, body in zip(self.joints[::-1], bodies[::-1], strict=True):
            armature = 0.0 if joint.spring else joint.rotor
            kind = "slide" if joint.slides else "hinge"
            hinge = f'<joint name="{joint.name}" type="{kind}" axis="{row(joint.axis)}" armature="{armature!r}"/>'
            tree = f'<body name="link_{joint.name}" pos="{row(joint.offset)}">{hinge}{_inertial(body)}{tree}</body>\n'
        free = '<freejoint name="base"/>' if self.floating else ""
        tree = f'<body name="root">{free}{_inertial(root)}{tree}</body>'
        for joint in self.joints:
            if joint.spring:  # MuJoCo needs some mass: turning about its centre, it has no weight in the equations
                grain = Body(1e-9, np.zeros(3), 1e-12 * np.eye(3))
                hinge = f'<joint name="rotor_{joint.name}" axis="0 0 1" armature="{joint.rotor!r}"/>'
                tree += f'<body name="rotor_{joint.name}">{hinge}{_inertial(grain)}</body>'
        return (
            '<mujoco><compiler angle="radian" boundmass="0" boundinertia="0" balanceinertia="false"/>'
            f'<option gravity="0 0 {-GRAVITY}"/><worldbody>{tree}</worldbody></mujoco>'
        )

    def leg(self, *, believed: bool = True) -> exoid.Leg:
        """Read what a user has, the URDF of the CAD, or the truth."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "machine.urdf"
            path.write_text(self.urdf(believed=believed), encoding="utf-8")
            base = "floating" if self.floating else "fixed"
            return exoid.Leg.from_urdf(path, self.names, cumulative=True, base=base)

    def terms(self) -> tuple[Term, ...]:
        """Terms of exoid in the true form, with true settings."""
        driven = [joint for joint in self.joints if not joint.passive]
        friction = [term for joint in self.joints for term in joint.friction.terms(joint.name)]
        rotors = () if self.sensing.torque == "sensor" else (exoid.Armature(joints=tuple(j.name for j in driven)),)
        return (*friction, *rotors)

    def with_sensing(self, **changes: object) -> Machine:
        """Change the log, and nothing else."""
        return replace(self, sensing=replace(self.sensing, **changes))

    def __str__(self) -> str:
        """Name it in one line."""
        s, base = self.sensing, "floating" if self.floating else "fixed"
        kinds = ", ".join("passive" if j.passive else j.friction.kind + "~" * bool(j.spring) for j in self.joints)
        return (
            f"{self.seed}: {len(self.joints)} joints, {'planar' if self.planar else 'spatial'}, {base}, "
            f"{self.mass:.3g} kg; {kinds}; {s.torque}, {s.colour} noise {100 * s.noise:.1f} %, {s.rate} Hz, "
            f"{s.bits} bits, delay {1e3 * s.delay:.2g} ms; {self.controller}, {' to '.join(self.motions)}"
        )


def draw(seed: int) -> Machine:
    """Draw a machine of 2 to 7 joints and 0.5 to 80 kg."""
    rng = np.random.default_rng([seed, 26])
    count, mass = int(rng.integers(2, 8)), float(np.exp(rng.uniform(np.log(0.5), np.log(80.0))))
    planar, floating = bool(rng.random() < 0.4), bool(rng.random() < 0.25)
    shares = rng.uniform(0.4, 1.0, count + 1) * 0.75 ** np.arange(count + 1)  # the last is that of the tool
    carries = rng.random() < 0.4
    masses = mass * shares / shares[: count + carries].sum()
    lengths = rng.uniform(0.5, 1.5, count + 1)
    lengths *= 0.55 * np.cbrt(mass) * rng.uniform(0.7, 1.3) / lengths.sum()
    bodies = tuple(_draw_body(rng, m, h) for m, h in zip(masses[:-1], lengths[:-1], strict=True))
    tool = _draw_body(rng, masses[-1], lengths[-1]) if carries else None
    root = _draw_body(rng, 0.5 * mass, 0.3 * lengths.sum())
    axes = np.tile([0.0, 1.0, 0.0], (count, 1)) if planar else _draw_axes(rng, count)
    axes *= rng.choice([-1.0, 1.0], (count, 1))
    passive = int(rng.integers(1, count)) if count > 2 and rng.random() < 0.2 else -1
    springs = rng.random(count) < (0.4 if rng.random() < 0.3 and not floating else 0.0)
    geared = rng.uniform(0.05, 0.6) if rng.random() < 0.8 else 0.02
    joints = []
    for k in range(count):
        beyond, reach = float(masses[k : count + carries].sum()), float(lengths[k:].sum())
        load, inertia = 0.5 * GRAVITY * beyond * reach, beyond * reach**2 / 3.0
        rotor = geared * rng.uniform(0.5, 1.5) * inertia
        c0, d = rng.uniform([0.01, 0.005], [0.08, 0.04]) * load
        kind = str(rng.choice(list(OF_C0)))
        frequency, draws = rng.uniform(12.0, 25.0), draw_friction(rng, kind, c0, d, load, rotor)
        stiffness = float((2.0 * np.pi * frequency) ** 2 * inertia) * bool(springs[k])
        offset = np.array([0.0, 0.1 * lengths[k] * rng.uniform(-1.0, 1.0), -lengths[k - 1] if k else 0.0])
        joint = Joint(f"j{k + 1}", axes[k], offset, draws, float(rotor), stiffness)
        if k == passive:
            viscous = 0.1 * float(np.sqrt(load * inertia))
            free = Friction("smooth", "smooth", 0.0, viscous)
            joint = replace(joint, friction=free, rotor=0.0, spring=0.0, passive=True)
        joints.append(joint)
    rate = int(rng.choice(RATES))
    sensing = Sensing(
        rate,
        str(rng.choice(TORQUES)),
        float(np.exp(rng.uniform(np.log(0.003), np.log(0.03)))),
        str(rng.choice(COLOURS)),
        int(rng.integers(12, 21)),
        float(rng.uniform(0.002, 0.01)) if rng.random() < 0.25 else 0.0,
    )
    wrong = 1.0 + 0.2 * rng.uniform(-1.0, 1.0, count + 1)
    wrong[int(rng.integers(1, count + 1))] *= 5.0 if rng.random() < 0.3 else 1.0
    believed = tuple(
        Body(float(x * body.mass), body.centre * rng.uniform(0.8, 1.2, 3), x * rng.uniform(0.8, 1.2) * body.inertia)
        for x, body in zip(wrong, (root, *bodies), strict=True)
    )
    kinds, end = pairs()[int(rng.integers(len(pairs())))], np.array([0.0, 0.0, -lengths[-2]])
    controller = str(rng.choice(CONTROLLERS))
    return Machine(seed, planar, floating, root, bodies, believed, tuple(joints), tool, end, controller, kinds, sensing)


def with_slides(machine: Machine) -> Machine:
    """Let every second joint slide, 0.1 m for each radian."""
    joints = [*machine.joints]
    for k, joint in enumerate(joints[::2]):
        f = joint.friction
        sizes = {name: 10.0 * getattr(f, name) for name in ("c0", "cs", "asymmetry")} | {"d": 100.0 * f.d}
        speeds = {name: 0.1 * getattr(f, name) for name in ("vs", "width", "length")}
        law = f._replace(**sizes, **speeds)
        joints[2 * k] = replace(joint, slides=True, friction=law, rotor=100.0 * joint.rotor, spring=0.0)
    return replace(machine, joints=tuple(joints), planar=False)


def _draw_body(rng: np.random.Generator, mass: float, length: float) -> Body:
    """Box of a link, somewhat turned."""
    x, y, z = (length * rng.uniform(0.1, 0.3, 3) + [0.0, 0.0, 0.7 * length]) ** 2
    principal = np.diag([y + z, x + z, x + y]) * mass / 12.0
    turn, _ = np.linalg.qr(np.eye(3) + 0.15 * rng.standard_normal((3, 3)))
    centre = length * rng.uniform([-0.1, -0.1, -0.6], [0.1, 0.1, -0.3])
    return Body(float(mass), centre, turn @ principal @ turn.T)


def _draw_axes(rng: np.random.Generator, count: int) -> Array:
    """Axes of which neighbours are not parallel, one in three of them tilted."""
    axes = np.eye(3)[(int(rng.integers(3)) + np.cumsum(rng.integers(1, 3, count))) % 3]
    axes += 0.3 * (rng.random((count, 1)) < 1 / 3) * rng.standard_normal((count, 3))
    return axes / np.linalg.norm(axes, axis=1, keepdims=True)


def _inertial(body: Body) -> str:
    inertia = row(body.inertia[i] for i in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
    return f'<inertial pos="{row(body.centre)}" mass="{body.mass!r}" fullinertia="{inertia}"/>'
