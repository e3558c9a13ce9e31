"""How the exoskeletons in urdf/ look: primitives only, placed in the frames of their links.

x forward, y left, z up, origin in the joint above. ``side`` is +1 for the left leg and −1 for the right one.
The bars stand in the plane of the joints, outside the wearer's limb.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

SIDES = {"left": 1.0, "right": -1.0}

LIMB = 0.10
"""How far the centre of the wearer's limb lies inside the leg's plane [m]."""

PALETTE = {
    "frame": "0.17 0.18 0.20 1",
    "joint": "0.28 0.29 0.32 1",
    "bar": "0.70 0.72 0.75 1",
    "barrel": "0.42 0.45 0.50 1",
    "chrome": "0.88 0.89 0.91 1",
    "cuff": "0.12 0.13 0.15 1",
    "strap": "0.24 0.22 0.20 1",
    "rubber": "0.07 0.07 0.07 1",
}
BLEEX_COLOURS = {**PALETTE, "shell": "0.10 0.23 0.42 1", "accent": "0.96 0.69 0.13 1"}
CUHK_COLOURS = {
    **PALETTE,
    "shell": "0.92 0.92 0.90 1",
    "accent": "0.45 0.17 0.55 1",
    "motor": "0.20 0.21 0.24 1",
}
DFKI_COLOURS = {**PALETTE, "accent": "0.10 0.45 0.70 1", "motor": "0.20 0.21 0.24 1"}


Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Visual:
    """A primitive in its link: box (three sizes), cylinder (radius, length along z) or sphere (radius)."""

    shape: str
    size: tuple[float, ...]
    xyz: Vector
    material: str
    rpy: Vector = (0.0, 0.0, 0.0)

    def moved(self, offset: Vector) -> Visual:
        """Return the same primitive shifted by an offset."""
        x, y, z = (a + b for a, b in zip(self.xyz, offset, strict=True))
        return Visual(self.shape, self.size, (x, y, z), self.material, self.rpy)


# -------------------------------------------------------------------------------------------- shapes


def box(material: str, size: Vector, xyz: Vector, pitch: float = 0.0) -> Visual:
    """A box, pitched about y."""
    return Visual("box", size, xyz, material, (0.0, pitch, 0.0))


def rod(material: str, radius: float, a: Vector, b: Vector) -> Visual:
    """A cylinder from point a to point b."""
    dx, dy, dz = (q - p for p, q in zip(a, b, strict=True))
    x, y, z = ((p + q) / 2 for p, q in zip(a, b, strict=True))
    rpy = (0.0, math.atan2(math.hypot(dx, dy), dz), math.atan2(dy, dx))
    return Visual("cylinder", (radius, math.hypot(dx, dy, dz)), (x, y, z), material, rpy)


def hub(material: str, radius: float, width: float, xyz: Vector) -> Visual:
    """A cylinder whose axis is the joint axis."""
    x, y, z = xyz
    return rod(material, radius, (x, y - width / 2, z), (x, y + width / 2, z))


def ring(material: str, radius: float, height: float, centre: Vector, span: tuple[float, float]) -> list[Visual]:
    """A piece of a band around a limb: decimate boxes from one bearing to another [deg, 0 forward, 90 left]."""
    pieces = 9
    step = math.radians(span[1] - span[0]) / pieces
    plate = (0.008, 2.08 * radius * math.tan(step / 2), height)
    bearings = [math.radians(span[0]) + (k + 0.5) * step for k in range(pieces)]
    places = [(centre[0] + radius * math.cos(b), centre[1] + radius * math.sin(b), centre[2]) for b in bearings]
    return [Visual("box", plate, p, material, (0.0, 0.0, b)) for p, b in zip(places, bearings, strict=True)]


def cuff(side: float, radius: float, height: float, z: float) -> list[Visual]:
    """A shell behind the limb and a strap before it, held by a bracket on the bar."""
    centre = (0.0, -side * LIMB, z)
    reach = max(LIMB - radius, 0.0) + 0.01
    bracket = box("frame", (0.03, reach, 0.04), (0.0, -side * reach / 2, z))
    return [
        bracket,
        *ring("cuff", radius, height, centre, (80, 280)),
        *ring("strap", radius, 0.4 * height, centre, (-80, 80)),
    ]


def piston(a: Vector, b: Vector, radius: float = 0.019) -> list[Visual]:
    """A hydraulic cylinder from a to b: barrel, end cap, rod, and an eye at either end."""
    middle, collar = (tuple(p + f * (q - p) for p, q in zip(a, b, strict=True)) for f in (0.56, 0.60))
    x, y, z = middle
    u, v, w = collar
    return [
        rod("barrel", radius, a, (x, y, z)),
        rod("accent", radius + 0.003, (x, y, z), (u, v, w)),
        rod("chrome", 0.45 * radius, (u, v, w), b),
        hub("frame", 0.016, 0.03, a),
        hub("frame", 0.016, 0.03, b),
    ]


def foot(side: float) -> list[Visual]:
    """Ankle housing, side plate, sole with rubber heel and toe pads, heel cup, toe and instep strap."""
    y = -side * LIMB
    return [
        hub("joint", 0.034, 0.05, (0, 0, 0)),
        hub("accent", 0.018, 0.058, (0, 0, 0)),
        box("frame", (0.045, 0.018, 0.10), (0, 0, -0.045)),
        box("frame", (0.06, 0.08, 0.014), (0, y * 0.35, -0.096)),
        box("bar", (0.20, 0.092, 0.014), (0.03, y, -0.092)),
        box("bar", (0.075, 0.088, 0.014), (0.163, y, -0.085), -0.2),
        box("rubber", (0.07, 0.096, 0.016), (-0.04, y, -0.107)),
        box("rubber", (0.09, 0.096, 0.016), (0.085, y, -0.107)),
        box("rubber", (0.075, 0.09, 0.012), (0.165, y, -0.098), -0.2),
        *ring("cuff", 0.046, 0.05, (-0.03, y, -0.062), (90, 270)),
        *(box("strap", (0.035, 0.006, 0.07), (0.08, y + d, -0.055)) for d in (-0.043, 0.043)),
        box("strap", (0.035, 0.092, 0.006), (0.08, y, -0.018)),
    ]


def harness(depth: float) -> list[Visual]:
    """Waist belt, shoulder straps and chest strap; depth is where the back plate stands."""
    waist, points = (
        (-0.02, 0.0, 0.12),
        [
            (-depth, 0.10, 0.55),
            (-0.05, 0.11, 0.61),
            (0.06, 0.11, 0.56),
            (0.10, 0.11, 0.42),
            (0.113, 0.09, 0.15),
        ],
    )
    parts = [*ring("cuff", 0.16, 0.09, waist, (-180, 0)), *ring("cuff", 0.16, 0.09, waist, (0, 180))]
    for s in SIDES.values():
        strap = [(x, s * y, z) for x, y, z in points]
        parts += [rod("strap", 0.014, a, b) for a, b in itertools.pairwise(strap)]
        parts += [Visual("sphere", (0.014,), bend, "strap") for bend in strap[1:-1]]
    return [*parts, rod("strap", 0.010, (0.103, -0.11, 0.40), (0.103, 0.11, 0.40))]


# --------------------------------------------------------------------------------------------- looks


def bleex_visuals(side: float, thigh: float, shank: float) -> dict[str, list[Visual]]:
    """A hydraulic leg: slim bars outside the limb, the knee's cylinder before, the ankle's behind them."""
    return {
        "thigh": [
            hub("joint", 0.05, 0.05, (0, 0, 0)),
            hub("accent", 0.026, 0.058, (0, 0, 0)),
            box("bar", (0.036, 0.024, thigh - 0.07), (0, 0, -thigh / 2)),
            box("frame", (0.07, 0.028, 0.03), (0.03, 0, -0.075)),
            *piston((0.062, 0, -0.075), (0.042, 0, 0.005 - thigh)),
            *cuff(side, 0.092, 0.11, -0.21),
        ],
        "shank": [
            hub("joint", 0.044, 0.05, (0, 0, 0)),
            hub("accent", 0.022, 0.058, (0, 0, 0)),
            box("frame", (0.05, 0.026, 0.025), (0.025, 0, 0)),
            box("bar", (0.032, 0.022, shank - 0.06), (0, 0, -shank / 2)),
            box("frame", (0.06, 0.026, 0.03), (-0.028, 0, -0.07)),
            *piston((-0.058, 0, -0.07), (-0.04, 0, 0.005 - shank), 0.017),
            *cuff(side, 0.07, 0.10, -0.19),
        ],
        "foot": [box("frame", (0.045, 0.024, 0.022), (-0.022, 0, 0)), *foot(side)],
    }


def bleex_torso(width: float) -> list[Visual]:
    """Pelvis frame with hip cylinders, back plate, power unit with engine block and accumulators, harness."""
    w = width + 0.04
    sides = [
        visual
        for s in SIDES.values()
        for visual in (
            box("frame", (0.22, 0.02, 0.05), (-0.08, s * w, 0.0)),
            box("frame", (0.04, 0.02, 0.10), (-0.17, s * w, 0.06)),
            *piston((-0.17, s * w, 0.30), (-0.045, s * w, 0.03)),
            rod("barrel", 0.032, (-0.29, s * 0.19, 0.22), (-0.29, s * 0.19, 0.50)),
            Visual("sphere", (0.032,), (-0.29, s * 0.19, 0.50), "barrel"),
        )
    ]
    return [
        box("frame", (0.04, 2 * w + 0.02, 0.05), (-0.17, 0, 0.10)),
        box("frame", (0.04, 2 * w + 0.02, 0.03), (-0.17, 0, 0.30)),
        box("bar", (0.02, 0.30, 0.48), (-0.185, 0, 0.34)),
        box("shell", (0.16, 0.30, 0.34), (-0.28, 0, 0.38)),
        box("joint", (0.13, 0.24, 0.08), (-0.28, 0, 0.59)),
        box("accent", (0.164, 0.304, 0.02), (-0.28, 0, 0.50)),
        *harness(0.18),
        *sides,
    ]


def cuhk_visuals(side: float, thigh: float, shank: float) -> dict[str, list[Visual]]:
    """An electric leg: flat motors at hip and knee, telescopic bars in white shells, foot on the shank."""
    motor = 0.046 * side
    return {
        "thigh": [
            hub("joint", 0.05, 0.05, (0, 0, 0)),
            box("shell", (0.062, 0.03, 0.19), (0, 0, -0.13)),
            box("accent", (0.014, 0.033, 0.15), (0, 0, -0.13)),
            box("bar", (0.036, 0.02, thigh - 0.18), (0, 0, -0.5 * thigh - 0.06)),
            hub("motor", 0.058, 0.042, (0, motor, -thigh)),
            hub("accent", 0.040, 0.052, (0, motor, -thigh)),
            *cuff(side, 0.092, 0.12, -0.22),
        ],
        "shank": [
            hub("joint", 0.046, 0.05, (0, 0, 0)),
            box("shell", (0.056, 0.028, 0.16), (0, 0, -0.12)),
            box("accent", (0.012, 0.031, 0.12), (0, 0, -0.12)),
            box("bar", (0.032, 0.018, shank - 0.16), (0, 0, -0.5 * shank - 0.06)),
            *cuff(side, 0.072, 0.11, -0.20),
            *(visual.moved((0.0, 0.0, -shank)) for visual in foot(side)),
        ],
    }


def cuhk_torso(width: float) -> list[Visual]:
    """Pelvis frame with the hip motors, back plate, battery and computer box, harness."""
    arm, motor = width + 0.03, width + 0.046
    sides = [
        visual
        for s in SIDES.values()
        for visual in (
            box("shell", (0.20, 0.016, 0.06), (-0.09, s * arm, 0.02)),
            hub("motor", 0.066, 0.042, (0, s * motor, 0)),
            hub("accent", 0.046, 0.052, (0, s * motor, 0)),
        )
    ]
    return [
        box("shell", (0.04, 2 * arm + 0.016, 0.08), (-0.19, 0, 0.03)),
        box("bar", (0.02, 0.24, 0.54), (-0.19, 0, 0.31)),
        box("shell", (0.10, 0.28, 0.30), (-0.25, 0, 0.38)),
        box("accent", (0.104, 0.05, 0.304), (-0.25, 0, 0.38)),
        box("motor", (0.09, 0.24, 0.10), (-0.245, 0, 0.16)),
        *harness(0.18),
        *sides,
    ]


def dfki_base() -> list[Visual]:
    """The wall mount behind the shoulder."""
    return [
        box("frame", (0.16, 0.03, 0.16), (0, 0.11, 0)),
        box("frame", (0.08, 0.05, 0.08), (0, 0.075, 0)),
    ]


def dfki_visuals(upper: float, lower: float) -> dict[str, list[Visual]]:
    """Two tubes with a motor at either joint, the elbow's riding on the upper link."""
    return {
        "upper_link": [
            hub("motor", 0.049, 0.04, (0, 0.03, 0)),
            hub("accent", 0.03, 0.01, (0, 0.005, 0)),
            rod("bar", 0.011, (0, 0, 0), (0, 0, -upper)),
            hub("motor", 0.049, 0.04, (0, 0.02, -upper)),
        ],
        "lower_link": [
            hub("accent", 0.03, 0.012, (0, -0.008, 0)),
            rod("bar", 0.010, (0, -0.01, 0), (0, -0.01, -lower)),
            hub("joint", 0.025, 0.03, (0, -0.01, -lower)),
        ],
    }
