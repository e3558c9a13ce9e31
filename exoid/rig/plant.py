"""True parameters of virtual rigs: bodies, springs, friction, rotors and end stops of one leg or of many."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import chain

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.leg import Leg
from exoid.leg.leg_data import refuse_floating_base
from exoid.tools.numbers import checked
from exoid.tools.tables import DataTable, to_text, value_range
from exoid.torques.position_units import heading, position_units

STIFFNESS_DEGREE = 2  # of the polynomial spring at each joint

SYMBOLS = ("b2", "b1", "b0", "c0", "cs", "d", "Ia")
"""Symbols of stiffness, kinetic, static and viscous friction, and rotor inertia in :meth:`Plant.build`."""


@dataclass(frozen=True, eq=False, repr=False)
class Plant:
    """B legs of the same geometry, each with its parameters; signs as in :class:`exoid.torques.Term`.

    Attributes:
        leg: Geometry of the leg.
        parameters: Rigid-body parameters in the order of ``leg.parameter_names``, (p, B).
        stiffness: Spring coefficients b2, b1, b0 of each joint [N·m/rad², N·m/rad, N·m], (3, n, B).
        coulomb: Kinetic friction [N·m], (n, B).
        static: Static (breakaway) friction [N·m], at least the kinetic one, (n, B).
        viscous: Viscous friction [N·m·s/rad], (n, B).
        armature: Reflected rotor inertia [kg·m²], (n, B).
        pitch: Tilt of the torso [rad], see :class:`exoid.TorsoMotion`, (B,).
        lower: Lower end stops [rad], (n, B); −inf for none.
        upper: Upper end stops [rad], (n, B); inf for none.

    Raises:
        ExoidError: The base of the leg floats, a shape is wrong, a value not finite, friction or rotor inertia
            negative, static friction below the kinetic one, or a lower end stop not below the upper one.
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

    def __post_init__(self) -> None:
        """Check base, shapes and signs."""
        refuse_floating_base(self.leg, "a rig")
        n, count = len(self.leg.joint_names), np.size(self.pitch)
        sizes = {"parameters": (len(self.leg.parameter_names), count), "stiffness": (3, n, count), "pitch": (count,)}
        for name in _array_names():
            values, shape = getattr(self, name), sizes.get(name, (n, count))
            if np.shape(values) != shape or count == 0:
                what = f"{name} of the plant has shape {np.shape(values)}"
                raise BadArgumentError(what, remedy=f"it must be {shape}")
            if name not in ("lower", "upper"):  # infinite for no end stop
                checked(values, f"{name} of the plant", ndim=3)
        if min(self.coulomb.min(), self.viscous.min(), self.armature.min()) < 0.0:
            remedy = "change the sign: document 1 counts friction torque on the joint, exoid that of the actuator"
            raise BadArgumentError("friction or rotor inertia is negative and would add energy", remedy=remedy)
        if not (self.static >= self.coulomb).all():
            remedy = "leave cs out, or make it at least c0"
            raise BadArgumentError("static friction is below the kinetic one", remedy=remedy)
        if not (self.lower < self.upper).all():
            raise BadArgumentError("a lower end stop is not below the upper one", remedy="check the limits of the URDF")

    @classmethod
    def build(
        cls, leg: Leg, values: Mapping[str, float] | None = None, *, pitch: ArrayLike = 0.0, end_stops: bool = True
    ) -> Plant:
        """Build a plant from parameter values by name, such as those of an estimate.

        Args:
            leg: The leg.
            values: Rigid-body parameters (``X1``) and ``symbol_joint`` of :data:`SYMBOLS` (``c0_hip``). Rigid-body
                parameters default to those of the leg, static friction to the kinetic one, all others to zero.
            pitch: Tilt of the torso [rad], one number or one for each of B rigs.
            end_stops: Whether joints stop at the limits of the URDF.

        Returns:
            B rigs, one for each pitch.

        Raises:
            ExoidError: The base of the leg floats, a name is unknown, a value violates a condition of the class, or
                the mass matrix is not positive definite at some pose.
        """
        refuse_floating_base(leg, "a rig")
        parameters, numbers = numbers_by_symbol(leg, SYMBOLS, values or {})
        pitches = np.atleast_1d(np.asarray(pitch, dtype=np.float64))
        if pitches.ndim != 1 or not len(pitches):
            what = f"pitch of the plant has shape {pitches.shape}"
            raise BadArgumentError(what, remedy="give one angle, or a row of them")
        _refuse_indefinite(leg, parameters, numbers["Ia"])
        given = [f"cs_{label}" in (values or {}) for label in leg.joint_labels]
        free = np.full(len(given), np.inf)
        lower, upper = (leg.limits.lower, leg.limits.upper) if end_stops else (-free, free)
        arrays = {
            "parameters": parameters,
            "stiffness": np.array([numbers[f"b{power}"] for power in range(STIFFNESS_DEGREE, -1, -1)]),
            "coulomb": numbers["c0"],
            "static": np.where(given, numbers["cs"], numbers["c0"]),
            "viscous": numbers["d"],
            "armature": numbers["Ia"],
            "lower": lower,
            "upper": upper,
        }
        alike = {name: np.repeat(x[..., None], len(pitches), axis=-1) for name, x in arrays.items()}
        return cls(leg=leg, pitch=pitches, **alike)

    @property
    def count(self) -> int:
        """Number of rigs B."""
        return len(self.pitch)

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.coulomb)

    def __repr__(self) -> str:
        """Name the leg, the joints and the number of rigs."""
        return f"Plant({self.description})"

    def __str__(self) -> str:
        """Print as a table: the range of each quantity over the rigs, one line a joint."""
        b2, b1, b0 = self.stiffness
        units = position_units(self.leg)
        ends = np.array([self.lower, self.upper]) / np.array([unit.size for unit in units])[:, None]
        columns = (self.coulomb, self.static, self.viscous, self.armature, b2, b1, b0, *ends)
        rows = list(zip(self.leg.joint_names, *(map(value_range, column) for column in columns), strict=True))
        at = heading(units)
        headers = ("joint", "c0", "cs", "d", "Ia", "b2", "b1", "b0", f"from [{at}]", f"to [{at}]")
        return to_text(DataTable(f"Plant: {self.description}; SI units", headers, rows))

    @property
    def description(self) -> str:
        """Number of rigs, name of the leg and names of the joints."""
        return f"{self.count} × {self.leg.description.name} ({', '.join(self.leg.joint_names)})"

    def repeat(self, count: int) -> Plant:
        """Repeat every rig: ``count`` copies of the first, then of the second, and so on.

        Args:
            count: Number of copies of each rig.

        Returns:
            ``count`` B rigs.
        """
        return self._each(lambda x: np.repeat(x, count, axis=-1))

    def take(self, rigs: Sequence[int] | slice) -> Plant:
        """Select some rigs.

        Args:
            rigs: Indices of the rigs.

        Returns:
            These rigs.
        """
        return self._each(lambda x: x[..., rigs])

    @staticmethod
    def concatenate(plants: Sequence[Plant]) -> Plant:
        """Combine plants of the same leg into one.

        Args:
            plants: At least one plant; all share one :class:`exoid.Leg` object.

        Returns:
            All rigs in order.

        Raises:
            ExoidError: There is no plant, or the legs differ.
        """
        if not plants or any(plant.leg is not plants[0].leg for plant in plants):
            raise BadArgumentError("the plants do not have the same leg", remedy="build all of them from one Leg")
        first = plants[0]
        arrays = {name: np.concatenate([getattr(plant, name) for plant in plants], axis=-1) for name in _array_names()}
        return Plant(leg=first.leg, **arrays)

    def _each(self, change: Callable[[FloatArray], FloatArray]) -> Plant:
        return Plant(leg=self.leg, **{name: change(getattr(self, name)) for name in _array_names()})


def numbers_by_symbol(
    leg: Leg, symbols: Sequence[str], values: Mapping[str, float]
) -> tuple[FloatArray, dict[str, FloatArray]]:
    """Read parameters of the bodies (``X1``), and numbers of the joints (``c0_hip``) by symbol, zero if not given."""
    named = {symbol: [f"{symbol}_{label}" for label in leg.joint_labels] for symbol in symbols}
    known = sorted(chain(leg.parameter_names, *named.values()))
    if unknown := sorted(set(values) - set(known)):
        raise BadArgumentError(f"the plant has no {', '.join(unknown)}", remedy=f"names are {', '.join(known)}")
    bodies = [values.get(name, own) for name, own in zip(leg.parameter_names, leg.parameters, strict=True)]
    return np.array(bodies), {s: np.array([values.get(name, 0.0) for name in names]) for s, names in named.items()}


def _array_names() -> list[str]:
    return [field.name for field in fields(Plant) if field.name != "leg"]


def _refuse_indefinite(leg: Leg, parameters: FloatArray, armature: FloatArray) -> None:
    """Refuse parameters for which the mass matrix is not positive definite at poses all over the workspace."""
    poses = np.random.default_rng(0).uniform(-np.pi, np.pi, (200, len(armature)))
    poses = poses if leg.closure is None else leg.closure.reachable(poses)
    M = leg.with_parameters(parameters).mass_matrix(poses) + np.diag(armature)
    if not np.linalg.eigvalsh(M)[:, 0].min() > 0.0:
        raise BadArgumentError(
            "the mass matrix is not positive definite: no rigid bodies have these parameters",
            where=leg.description.name,
            remedy="check the moments of inertia, and whether J is cumulative",
        )
