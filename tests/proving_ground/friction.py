"""Eight laws of joint friction as one formula and a table of the coefficients that each law draws.

    tau = (c0 (1 + drift e^(-t / warm)) + asymmetry sgn v + cs e^(-(v / vs)^2) + mu |load|) s + d v

s is the direction of sliding: the friction constraint of the simulator ("sharp"), tanh(v / width) ("smooth"), or the
state of Dahl's presliding, dz = (1 - z sgn dq) dq / length ("presliding").
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import exoid
from exoid.torques import LoadFriction, Stribeck, Term

Array = NDArray[np.float64]

STEP = 1.0 / 4000.0
"""Step of the simulation [s]. It resolves the stiffness of every contact that is drawn."""


class Friction(NamedTuple):
    """Friction of one joint, or as arrays that of all joints.

    Attributes:
        kind: Name of the law.
        transition: How friction changes sign: "sharp", "smooth" or "presliding".
        c0: Coulomb friction [N·m].
        d: Viscous friction [N·m·s/rad].
        cs: Stribeck friction [N·m], negative for a concave law.
        vs: Stribeck velocity [rad/s].
        mu: Friction for each N·m of rigid-body torque that the gear carries.
        asymmetry: What forward sliding has more than backward sliding, halved [N·m].
        drift: What a cold joint has more, in parts of c0.
        warm: Time constant of warming up [s].
        width: Velocity of smooth friction [rad/s].
        length: Presliding length [rad].
    """

    kind: str
    transition: str
    c0: float
    d: float
    cs: float = 0.0
    vs: float = 1.0
    mu: float = 0.0
    asymmetry: float = 0.0
    drift: float = 0.0
    warm: float = 1.0
    width: float = 1.0
    length: float = 1.0

    def largest(self, load: float) -> float:
        """Bound of dry friction at a load [N·m]."""
        return self.c0 * (1.0 + self.drift) + abs(self.asymmetry) + max(self.cs, 0.0) + self.mu * load

    def terms(self, joint: str) -> tuple[Term, ...]:
        """Terms of exoid with the true settings; the drift has none."""
        where = {"joints": (joint,)}
        how = {
            "sharp": {},  # as the default terms
            "smooth": {"smoothing": self.width, "reversal_speed": 0.0},
            "presliding": {"presliding": self.length},
        }[self.transition]
        terms = [exoid.Coulomb(**where, **how), exoid.Viscous(**where), exoid.Offset(**where)]
        if self.cs:
            terms.append(Stribeck(velocity=self.vs, **where, **how))
        if self.mu:
            terms.append(LoadFriction(**where, **how))
        return tuple(terms)


OF_C0 = {
    "sharp": {},
    "smooth": {},
    "presliding": {},
    "concave": {"cs": (-0.7, -0.3), "vs": (0.05, 0.5)},
    "stribeck": {"cs": (0.2, 0.6), "vs": (0.03, 0.2)},
    "load": {"mu": (0.05, 0.2)},
    "asymmetric": {"asymmetry": (0.1, 0.4)},
    "drifting": {"drift": (0.3, 0.6), "warm": (10.0, 60.0)},
}
"""Range of the coefficients that a law has besides c0 and d; cs and asymmetry in parts of c0."""


def draw_friction(rng: np.random.Generator, kind: str, c0: float, d: float, load: float, inertia: float) -> Friction:
    """Draw a law for a joint of this inertia [kg·m²] and load [N·m], as stiff as the step resolves."""
    transitions = ("sharp", "smooth", "presliding")
    numbers = {name: rng.uniform(*between) for name, between in OF_C0[kind].items()}
    numbers |= {name: c0 * numbers[name] for name in ("cs", "asymmetry") if name in numbers}
    law = Friction(kind, kind if kind in transitions else str(rng.choice(transitions)), c0, d, **numbers)
    length, width = np.exp(rng.uniform(np.log([2e-5, 0.01]), np.log([5e-4, 0.05])))
    # A contact of stiffness F / length oscillates stably if (F / length) STEP² < 4 inertia; damping F / width likewise.
    force = law.largest(load)
    stiff, steep = force * STEP**2 / (0.3 * inertia), force * STEP / (0.3 * inertia)
    return law._replace(length=max(float(length), stiff), width=max(float(width), steep))


class Laws:
    """Friction of all joints in time: it keeps the state of presliding."""

    def __init__(self, joints: Sequence[Friction]) -> None:
        """Stack the coefficients."""
        self.of = Friction(*(np.array(values) for values in zip(*joints, strict=True)))
        self.sharp, self.bent = self.of.transition == "sharp", self.of.transition == "presliding"
        self.z = np.zeros(len(joints))

    def level(self, v: Array, load: Array, time: float) -> Array:
        """Dry friction of a joint that slides [N·m]."""
        f = self.of
        stribeck = f.cs * np.exp(-((v / f.vs) ** 2))
        return f.c0 * (1.0 + f.drift * np.exp(-time / f.warm)) + f.asymmetry * np.sign(v) + stribeck + f.mu * abs(load)

    def slide(self, path: Array) -> None:
        """Move presliding on by a step along the path."""
        s = np.sign(path)
        self.z = s + (self.z - s) * np.exp(-np.abs(path) / self.of.length)

    def torque(self, v: Array, level: Array) -> Array:
        """Friction without that of sharp joints, which the simulator adds [N·m]."""
        s = np.where(self.bent, self.z, np.tanh(v / self.of.width))
        return np.where(self.sharp, 0.0, level * s) + self.of.d * v
