"""True parameters of a machine on the ground: bodies, soles, friction, rotors, springs."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.leg.catalog import load_exo
from exoid.leg.description import FARTHEST
from exoid.leg.leg import Leg
from exoid.leg.link_frames import link_frame
from exoid.leg.reduction import Plane
from exoid.leg.reduction.planar import GRAVITY
from exoid.rig.plant import numbers_by_symbol
from exoid.tools.numbers import checked

SYMBOLS = ("c0", "d", "Ia", "b1", "b0")
"""Symbols of what acts on a joint: Coulomb and viscous friction, rotor, spring and its torque at zero."""


@dataclass(frozen=True, eq=False)
class Sole:
    """Sole of a foot: small spheres at its corners, whose lowest points lie in one plane while the foot stands.

    Attributes:
        points: Lowest points of the spheres in the axes of the link of the foot, whose z axis points up while the foot
            stands [m], (K, 3). Heel and toe are enough for a machine that moves in a plane.
        radius: Radius of the spheres [m].

    Raises:
        ExoidError: The points are not a (K, 3) array of at least two places in m, or the radius is not positive.
    """

    points: FloatArray
    radius: float = 0.005

    def __post_init__(self) -> None:
        """Check shape and unit."""
        points = np.array(self.points, dtype=np.float64)
        if points.ndim != 2 or points.shape[1:] != (3,) or len(points) < 2 or not (np.abs(points) <= FARTHEST).all():
            remedy = f"give at least heel and toe in m, (K, 3), at most {FARTHEST:g} m from the origin of the link"
            raise BadArgumentError(f"a sole with points of shape {points.shape}", remedy=remedy)
        checked(self.radius, "the radius of the spheres of a sole", above=0.0, most=FARTHEST)
        points.flags.writeable = False
        object.__setattr__(self, "points", points)

    @classmethod
    def flat(cls, heel: float, toe: float, height: float, *, side: float = 0.0, width: float = 0.0) -> Sole:
        """Make a flat sole that is parallel to the x and y axes of its link.

        Args:
            heel: Position of the heel along x [m].
            toe: Position of the toe along x [m].
            height: Position of the sole along z [m].
            side: Position of the middle of the sole along y [m].
            width: Width along y [m]; 0 for two points instead of four.

        Returns:
            The sole.
        """
        sides = [side] if width == 0.0 else [side - width / 2, side + width / 2]
        return cls(np.array([(x, y, height) for x in (heel, toe) for y in sides]))

    @property
    def centre(self) -> FloatArray:
        """Mean of the points in the axes of the link [m], (3,)."""
        return np.asarray(self.points.mean(axis=0))


@dataclass(frozen=True)
class Block:
    """Box on the ground, across the whole width: a step of stairs, a chair, or 1 mm high a slippery patch.

    Attributes:
        start: Place of its back along forward [m].
        stop: Place of its front [m].
        height: Height of its top above the ground [m].
        friction: Coefficient of friction on it; None for that of the ground.

    Raises:
        ExoidError: The box has no length or height, or friction is not positive.
    """

    start: float
    stop: float
    height: float
    friction: float | None = None

    def __post_init__(self) -> None:
        """Check size and friction."""
        checked([self.start, self.stop], "the ends of a block [m]")
        checked([self.stop - self.start, self.height], "the size of a block [m]", above=0.0)
        checked(1.0 if self.friction is None else self.friction, "the friction of a block", above=0.0)


BLEEX_SOLES: Mapping[str, Sole] = MappingProxyType(
    {"left_foot": Sole.flat(-0.075, 0.13, -0.115, side=-0.1), "right_foot": Sole.flat(-0.075, 0.13, -0.115, side=0.1)}
)
"""Soles of BLEEX as its URDF draws them, an assumption: the document has no drawing of the foot."""

CUHK_SOLES: Mapping[str, Sole] = MappingProxyType(
    {f"{side}_shank": Sole(np.array([(0.0, -0.03, -0.4182), (0.0, 0.03, -0.4182)])) for side in ("left", "right")}
)
"""Passive ankles of CUHK-EXO at the end of its shanks (L_s by Winter's table): they hold no moment."""

SOLES: Mapping[str, Mapping[str, Sole]] = MappingProxyType({"bleex": BLEEX_SOLES, "cuhk": CUHK_SOLES})
"""Soles of the built-in machines."""

SEAT = Sole.flat(-0.12, -0.02, -0.09)
"""Part of a torso that a chair bears, an assumption: below and behind the hip."""


def soles_of(leg: Leg, soles: Mapping[str, Sole] | None) -> Mapping[str, Sole]:
    """Soles that are given, or those of the built-in machine that the leg is by its name and lengths."""
    known, name = soles, re.split(r"[._]", leg.description.name)[0]
    if soles is None and name in SOLES:
        own, built_in = ([limb.chain.offsets.round(9) for limb in one.limbs[:1]] for one in (leg, load_exo(name)))
        known = SOLES[name] if np.array_equal(own, built_in) else None
    if not known:
        raise BadArgumentError(
            "the soles of this machine are not known",
            where=leg.description.name,
            remedy='give soles={"left_foot": exoid.rig.ground.Sole.flat(heel, toe, height), ...}',
            command="plan with --sole FOOT=HEEL,TOE,HEIGHT; write a law in Python: exoid.control.stance(est, soles)",
        )
    return MappingProxyType(dict(known))


@dataclass(frozen=True, eq=False, repr=False)
class GroundPlant:
    """Torso and legs that stand or walk on flat ground, with their true parameters.

    Joints have friction c0 tanh(v / smoothing) + d v, a rotor Ia and a spring b1 q + b0, all relative to the link
    above, so that

        [W_b; W_q] π = [0; τ − c0 tanh(v / smoothing) − d v − Ia a − b1 q − b0] + Σ Jᵀ w.

    Attributes:
        leg: True rigid bodies, with ``base="floating"``. A planar machine moves forward, up and in pitch, any other in
            space.
        soles: Sole of each foot by the name of its link.
        coulomb: Coulomb friction c0 [N·m], (n,).
        viscous: Viscous friction d [N·m·s/rad], (n,).
        armature: Rotor inertia Ia at the joint [kg·m²], (n,).
        stiffness: Stiffness b1 [N·m/rad], (n,).
        constant: Torque b0 of the spring at zero [N·m], (n,).
        smoothing: Velocity over which Coulomb friction changes its sign [rad/s].
        ground_friction: Coefficient of friction of the ground.
        ground_lean: Angle by which the ground rises forward [rad]. The laboratory's axes are those of the ground.
        blocks: Boxes on the ground.
    """

    leg: Leg
    soles: Mapping[str, Sole]
    coulomb: FloatArray
    viscous: FloatArray
    armature: FloatArray
    stiffness: FloatArray
    constant: FloatArray
    smoothing: float = 0.02
    ground_friction: float = 0.8
    ground_lean: float = 0.0
    blocks: tuple[Block, ...] = ()

    @classmethod
    def build(
        cls,
        leg: Leg,
        soles: Mapping[str, Sole],
        values: Mapping[str, float] | None = None,
        *,
        smoothing: float = 0.02,
        ground_friction: float = 0.8,
    ) -> GroundPlant:
        """Build a plant from parameter values by name, such as those of an estimate.

        Args:
            leg: Legs on a floating base, with the true inertias.
            soles: Sole of each foot by the name of its link.
            values: Values of ``symbol_joint`` with the symbols :data:`SYMBOLS` (``c0_left_hip``), zero if not given,
                and rigid-body parameters by name (``X1_left``), those of ``leg`` if not given.
            smoothing: Velocity over which Coulomb friction changes its sign [rad/s].
            ground_friction: Coefficient of friction of the ground.

        Returns:
            The plant.

        Raises:
            ExoidError: The base of the leg does not float, a name is unknown, a link is missing, or a value has the
                wrong sign.
        """
        if leg.base != "floating":
            raise NotSupportedError(
                f"a machine on the ground needs a floating base, not {leg.base!r}",
                where=leg.description.name,
                remedy='load it with exoid.load_exo("bleex", base="floating") or Leg.from_urdf(..., base="floating")',
            )
        bodies, each = numbers_by_symbol(leg, SYMBOLS, values or {})
        if not np.array_equal(bodies, leg.parameters):
            leg = leg.with_parameters(bodies)
        for symbol, numbers in each.items():
            checked(numbers, f"{symbol} of the plant", least=0.0 if symbol in ("c0", "d", "Ia") else -np.inf)
        checked(smoothing, "smoothing", above=0.0)
        checked(ground_friction, "the friction of the ground", above=0.0)
        if not soles:
            raise BadArgumentError("the machine has no sole", remedy='give soles={"left_foot": Sole.flat(...)}')
        for link in soles:
            link_frame(leg.model, leg.description, link)
        return cls(
            leg=leg,
            soles=MappingProxyType(dict(soles)),
            coulomb=each["c0"],
            viscous=each["d"],
            armature=each["Ia"],
            stiffness=each["b1"],
            constant=each["b0"],
            smoothing=smoothing,
            ground_friction=ground_friction,
        )

    @property
    def is_planar(self) -> bool:
        """Whether the machine moves in a plane."""
        return self.leg.base_rows == 3

    @property
    def plane(self) -> Plane:
        """Directions forward, lateral and up in the axes of the root link, which is parallel to the laboratory."""
        return Plane(*np.eye(3)) if self.leg.machine is None else self.leg.machine.plane

    @property
    def gravity(self) -> FloatArray:
        """Gravity in the axes of the ground [m/s²], (3,)."""
        forward, _, up = self.plane
        return np.asarray(-GRAVITY * (np.cos(self.ground_lean) * up + np.sin(self.ground_lean) * forward))

    @property
    def root_link(self) -> str:
        """Name of the root link, the torso."""
        return self.leg.description.root_link

    @property
    def values(self) -> dict[str, float]:
        """True values of all parameters by name, such as X1_left, c0_left_hip."""
        each = dict(
            zip(SYMBOLS, (self.coulomb, self.viscous, self.armature, self.stiffness, self.constant), strict=True)
        )
        named = {
            f"{s}_{label}": x for s, xs in each.items() for label, x in zip(self.leg.joint_labels, xs, strict=True)
        }
        bodies = zip(self.leg.parameter_names, self.leg.parameters, strict=True)
        return {name: float(x) for name, x in (*bodies, *named.items())}

    def resistance(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """Compute the torque of friction and springs, which actuators overcome.

        Args:
            q: Joint angles [rad], (N, n).
            v: Joint velocities [rad/s], (N, n).

        Returns:
            Torque c0 tanh(v / smoothing) + d v + b1 q + b0 [N·m], (N, n).
        """
        return self.friction(v) + self.stiffness * q + self.constant

    def friction(self, v: FloatArray) -> FloatArray:
        """Compute the torque of friction.

        Args:
            v: Joint velocities [rad/s], (N, n).

        Returns:
            Torque c0 tanh(v / smoothing) + d v [N·m], (N, n).
        """
        return np.asarray(self.coulomb * np.tanh(v / self.smoothing) + self.viscous * v)

    def __repr__(self) -> str:
        """Name the machine, its joints and its feet."""
        joints, feet = (", ".join(names) for names in (self.leg.joint_names, self.soles))
        return f"GroundPlant({self.leg.description.name}: {joints}; on {feet})"
