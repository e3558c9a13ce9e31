"""The truth behind a virtual rig: bodies, springs, friction, rotors and end stops of one leg, or of many at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError
from exoid.leg import Leg

STIFFNESS_DEGREE = 2
"""Of the polynomial spring at each joint."""

SYMBOLS = ("b2", "b1", "b0", "c0", "cs", "d", "Ia")
"""Stiffness, kinetic and static friction, viscous friction, rotor inertia: ``symbol_joint`` in :meth:`Plant.build`."""


@dataclass(frozen=True, eq=False)
class Plant:
    """B legs of the same geometry with their own parameters, signs as in :class:`exoid.torques.Term`.

    Attributes:
        leg: Geometry, and the rigid bodies where ``parameters`` do not say otherwise.
        parameters: Of the rigid bodies, in the order of ``leg.parameter_names``, (p, B).
        stiffness: b2, b1, b0 of each joint [N·m/rad², N·m/rad, N·m], (3, n, B).
        coulomb: Kinetic friction [N·m], (n, B).
        static: Friction that must be overcome to break away [N·m], at least the kinetic one, (n, B).
        viscous: [N·m·s/rad], (n, B).
        armature: Reflected rotor inertia [kg·m²], (n, B).
        pitch: Tilt of the torso [rad], see :class:`exoid.TorsoMotion`, (B,).
        lower: End stops [rad], (n, B); −inf for none.
        upper: End stops [rad], (n, B).
    """

    leg: Leg
    parameters: FloatArray
    stiffness: FloatArray
    coulomb: FloatArray
    static: FloatArray
    viscous: FloatArray
    armature: FloatArray
    pitch: FloatArray
    lower: FloatArray
    upper: FloatArray

    @classmethod
    def build(
        cls,
        leg: Leg,
        values: Mapping[str, float] | None = None,
        *,
        pitch: ArrayLike = 0.0,
        end_stops: bool = True,
    ) -> Plant:
        """Build the truth from parameter values by name, such as those of an estimate.

        Args:
            leg: The leg.
            values: Its parameters (``X1``) and ``symbol_joint`` of :data:`SYMBOLS` (``c0_hip``); what is not named is
                the leg's own, or zero. Static friction is the kinetic one unless named.
            pitch: Tilt of the torso [rad], one number or one for each of B rigs.
            end_stops: Whether joints stop at the limits of the URDF.

        Raises:
            ExoidError: A name is unknown, a value not finite, or friction or rotor inertia negative.
        """
        values = dict(values or {})
        labels = leg.joint_labels
        known = {*leg.parameter_names, *(f"{symbol}_{label}" for symbol in SYMBOLS for label in labels)}
        unknown = sorted(set(values) - known)
        if unknown:
            raise ExoidError(f"the rig knows no {', '.join(unknown)}", remedy=f"names are {', '.join(sorted(known))}")
        if not all(np.isfinite(value) for value in values.values()):
            raise ExoidError(f"not finite: {[name for name, x in values.items() if not np.isfinite(x)]}")
        pitches = np.atleast_1d(np.asarray(pitch, dtype=np.float64))
        shape = (len(labels), len(pitches))

        def each(symbol: str, default: Mapping[str, float] | None = None) -> FloatArray:
            named = [values.get(f"{symbol}_{label}", (default or {}).get(label, 0.0)) for label in labels]
            return np.tile(np.array(named)[:, None], (1, shape[1]))

        coulomb = each("c0")
        static = np.maximum(each("cs"), coulomb)
        viscous, armature = each("d"), each("Ia")
        if min(coulomb.min(), viscous.min(), armature.min()) < 0.0:
            raise ExoidError(
                "friction or rotor inertia is negative and would feed energy in",
                remedy="torques of the documents count friction on the joint: change the sign",
            )
        parameters = np.array(
            [values.get(name, own) for name, own in zip(leg.parameter_names, leg.parameters, strict=True)]
        )
        free = np.full(len(labels), np.inf)
        lower, upper = (leg.limits.lower, leg.limits.upper) if end_stops else (-free, free)
        return cls(
            leg=leg,
            parameters=np.tile(parameters[:, None], (1, shape[1])),
            stiffness=np.array([each(f"b{power}") for power in range(STIFFNESS_DEGREE, -1, -1)]),
            coulomb=coulomb,
            static=static,
            viscous=viscous,
            armature=armature,
            pitch=pitches,
            lower=np.tile(lower[:, None], (1, shape[1])),
            upper=np.tile(upper[:, None], (1, shape[1])),
        )

    @property
    def count(self) -> int:
        """Number of rigs B."""
        return len(self.pitch)

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.coulomb)

    def each(self, count: int) -> Plant:
        """Put ``count`` copies of the first rig side by side, then as many of the second, and so on."""
        return self._each(lambda x: np.repeat(x, count, axis=-1))

    def take(self, rigs: Sequence[int] | slice) -> Plant:
        """Keep only some rigs."""
        return self._each(lambda x: x[..., rigs])

    @staticmethod
    def join(plants: Sequence[Plant]) -> Plant:
        """Put plants of the same geometry side by side."""
        first = plants[0]
        arrays = {name: np.concatenate([getattr(plant, name) for plant in plants], axis=-1) for name in _array_names()}
        return Plant(leg=first.leg, **arrays)

    def _each(self, change: Callable[[FloatArray], FloatArray]) -> Plant:
        return Plant(leg=self.leg, **{name: change(getattr(self, name)) for name in _array_names()})


def _array_names() -> list[str]:
    return [field.name for field in fields(Plant) if field.name != "leg"]
