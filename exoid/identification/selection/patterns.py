"""Friction models of one joint that are compared: which coefficients they have, at which settings, and an offset."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.torques import Coulomb, LoadFriction, Offset, Stribeck, Term, Viscous
from exoid.torques.catalog import SLIDE
from exoid.torques.terms import SMOOTHING, DryFriction

LOAD = ("mu", "mu_drive", "mu_back")
DRY = ("c0", *LOAD, "cs")
"""Symbols of load friction, and of all dry friction, which may have presliding."""

ALWAYS = ("c0", "d")
"""Symbols that a joint keeps unless they are negative: nearly every machine has them."""

VELOCITIES = (0.02, 0.03, 0.06, 0.085, 0.12, 0.17, 0.25, 0.35, 0.5)
"""Stribeck velocities that are tried [rad/s]. A model whose best velocity describes reversals loses; the last is an
upper bound. Beyond, it is no matter of slow motion."""


class Column(NamedTuple):
    """One coefficient at given settings."""

    symbol: str  # c0, d, mu, mu_drive, mu_back, cs, or offset
    length: float = 0.0  # presliding length [rad]; 0 for none
    velocity: float = 0.0  # Stribeck velocity [rad/s]; 0 for other friction
    smoothing: float = SMOOTHING  # velocity over which dry friction without presliding changes sign [rad/s]

    @property
    def term(self) -> Term:
        """Term that has the coefficient."""
        if self.symbol in {"d", "offset"}:
            return Viscous() if self.symbol == "d" else Offset()
        kinds: dict[str, DryFriction] = {
            "c0": Coulomb(),
            "mu": LoadFriction(),
            "mu_drive": LoadFriction(split=True),
            "mu_back": LoadFriction(split=True),
            "cs": Stribeck(velocity=self.velocity or VELOCITIES[0]),
        }
        if self.length:
            return replace(kinds[self.symbol], presliding=self.length)
        return replace(kinds[self.symbol], smoothing=self.smoothing)


Columns = tuple[Column, ...]

PLAIN = (Column("c0"), Column("d"), Column("offset"))
"""Where the search begins, and what a choice is compared with."""


class Pattern(NamedTuple):
    """Coefficients that a friction model has, whatever their settings."""

    # Friction dissipates at every speed and under every load if c0 + cs e^(-(v / vs)²) is positive, at 0 and beyond vs,
    # and d and load friction are. A negative cs with c0 + cs > 0 is friction that grows with speed to a limit.

    symbols: tuple[str, ...]  # symbols of the coefficients
    presliding: bool  # whether dry friction has presliding

    @property
    def complexity(self) -> float:
        """Number of coefficients and settings; load friction in one direction of power only counts half more."""
        # Smoothing or presliding is always there, the one or the other. Nor do c0 and d count, which every joint has.
        numbers = len({*self.symbols} - {*ALWAYS}) + ("cs" in self.symbols)
        return numbers + 0.5 * ("mu_back" in self.symbols and "mu_drive" not in self.symbols)

    def dissipative(self, coefficients: FloatArray) -> NDArray[np.bool_]:
        """Say which sets of coefficients are those of friction that dissipates."""
        of = dict(zip(self.symbols, coefficients.T, strict=True))
        low = of["c0"] + np.minimum(of["cs"], 0.0) if "cs" in of else of.get("c0", np.ones(len(coefficients)))
        rest = [c > 0.0 for symbol, c in of.items() if symbol not in ("c0", "cs", "offset")]
        return np.asarray(np.all([low > 0.0, *rest], axis=0))

    def lacks(self, other: Pattern) -> bool:
        """Say whether another pattern is this one with c0, d or both."""
        more = {*other.symbols} - {*self.symbols}
        return self.presliding == other.presliding and {*self.symbols} < {*other.symbols} and more <= {*ALWAYS}

    def within(self, other: Pattern) -> bool:
        """Say whether another pattern can be this one, with coefficients that are zero or equal."""
        load = {"mu"} if {"mu_drive", "mu_back"} <= set(other.symbols) else set()
        return {*self.symbols} <= {*other.symbols, *load} and (other.presliding or not self.presliding)

    def columns(self, length: float, velocity: float, smoothing: float = SMOOTHING) -> Columns:
        """Coefficients at settings."""
        length, smoothing = (length, SMOOTHING) if self.presliding else (0.0, smoothing)
        return tuple(
            Column(symbol, length, velocity if symbol == "cs" else 0.0, smoothing) if symbol in DRY else Column(symbol)
            for symbol in self.symbols
        )


class Grid(NamedTuple):
    """Settings that are tried for one joint."""

    # presliding lengths [rad]: those of industrial arms begin at 0.02 mrad
    lengths: tuple[float, ...] = (2e-5, 5e-5, 1.2e-4, 3e-4, 6e-4, 1.2e-3, 2.5e-3, 5e-3, 0.01, 0.02)
    velocities: tuple[float, ...] = VELOCITIES  # Stribeck velocities [rad/s]
    smoothings: tuple[float, ...] = (0.004, 0.008, SMOOTHING, 0.03)  # of friction without presliding [rad/s]

    @property
    def columns(self) -> Columns:
        """All coefficients at all settings."""
        every = [Pattern((symbol,), bent) for symbol in ("d", "offset", *DRY) for bent in (False, True)]
        return tuple(dict.fromkeys(columns[0] for pattern in every for columns in self.settings(pattern)))

    def settings(self, pattern: Pattern) -> list[Columns]:
        """List a pattern at all settings that it has."""
        dry = bool({*DRY} & {*pattern.symbols})
        lengths = self.lengths if pattern.presliding else (0.0,)
        smoothings = self.smoothings if dry and not pattern.presliding else (SMOOTHING,)
        velocities = self.velocities if "cs" in pattern.symbols else (0.0,)
        return [
            pattern.columns(length, velocity, smoothing)
            for length, velocity, smoothing in itertools.product(lengths, velocities, smoothings)
            if length or not velocity or velocity >= 2.0 * smoothing  # the smoothing hides slower Stribeck friction
        ]

    def about(self, columns: Columns, sweep: int) -> Grid:
        """Add settings about those of a choice, two on each side, finer from sweep to sweep."""
        step = (1.18, 1.06, 1.02)[min(sweep, 3) - 1]
        factors = [step**power for power in (-2, -1, 0, 1, 2)]
        lengths = {factor * column.length for column in columns if column.length for factor in factors}
        velocities = {factor * column.velocity for column in columns if column.velocity for factor in factors}
        sharp = {column.smoothing for column in columns if column.symbol in DRY and not column.length}
        smoothings = {factor * smoothing for smoothing in sharp for factor in factors}
        slow = {velocity for velocity in velocities if VELOCITIES[0] <= velocity <= VELOCITIES[-1]}
        pairs = (self.lengths, lengths), (self.velocities, slow), (self.smoothings, smoothings)
        return Grid(*(tuple(sorted({*old, *new})) for old, new in pairs))


def patterns() -> tuple[Pattern, ...]:
    """List all friction models of one joint, the simplest first."""
    # Gears lose more when they are driven back: friction under load in one direction of power is that one.
    # Stribeck friction is an addition to Coulomb friction: alone it would vanish at speed.
    loads = ((), ("mu",), ("mu_back",), ("mu_drive", "mu_back"))
    found = [Pattern((), presliding=False), Pattern(("d",), presliding=False)]
    for bent, load, viscous, fading in itertools.product((False, True), loads, ((), ("d",)), ((), ("cs",))):
        found.append(Pattern(("c0", *load, *viscous, *fading), bent))
        if load and not fading:
            found.append(Pattern((*load, *viscous), bent))
    found += [pattern._replace(symbols=(*pattern.symbols, "offset")) for pattern in found]
    return tuple(sorted(found, key=lambda pattern: pattern.complexity))


def terms_of(columns: Columns, joint: str, radian: float = 1.0) -> tuple[Term, ...]:
    """Terms of a joint, in the order of their coefficients, at what counts as a radian there."""
    terms = dict.fromkeys(column.term for column in columns)
    return tuple(replace(scaled(term, radian), joints=(joint,)) for term in terms)


def scaled(term: Term, radian: float) -> Term:
    """Term at what counts as a radian."""
    names = "smoothing", "presliding", "reversal_speed", "velocity"
    return replace(term, **{name: radian * getattr(term, name) for name in names if hasattr(term, name)})


def absent(columns: Columns) -> Columns:
    """Coulomb and viscous friction that a choice leaves out: an estimate, and a URDF, has them as zero."""
    like = next((column for column in columns if column.symbol in DRY), Column("c0"))
    plain = (Column("c0", like.length, smoothing=like.smoothing), Column("d"))
    return tuple(column for column in plain if column.symbol not in {each.symbol for each in columns})


class JointFriction(NamedTuple):
    """Friction model that was chosen for a joint."""

    joint: str  # name of the joint
    coefficients: tuple[str, ...]  # symbols of its coefficients, all positive but the offset and cs
    presliding: float  # presliding length [rad]; 0 for none
    smoothing: float  # velocity over which dry friction changes sign [rad/s]; 0 with presliding and without it
    stribeck_velocity: float  # [rad/s]; 0 for none
    slides: bool = False  # whether it is prismatic, with m for rad

    @classmethod
    def of(cls, joint: str, columns: Columns, radian: float = 1.0) -> JointFriction:
        """Describe the friction of a joint, at what counts as a radian there."""
        length, velocity = (max((getattr(c, name) for c in columns), default=0.0) for name in ("length", "velocity"))
        sharp = [c.smoothing for c in columns if c.symbol in DRY and not length]
        length, smoothing, velocity = (radian * x for x in (length, max(sharp, default=0.0), velocity))
        return cls(joint, tuple(c.symbol for c in columns), length, smoothing, velocity, radian != 1.0)

    @property
    def text(self) -> str:
        """A few words, such as "c0, mu_back, presliding 0.65 mrad"."""
        unit, usual = ("m", SLIDE * SMOOTHING) if self.slides else ("rad", SMOOTHING)
        settings = (
            f"presliding {1e3 * self.presliding:.2g} m{unit}" if self.presliding else "",
            f"smoothing {self.smoothing:.2g} {unit}/s" if self.smoothing not in (0.0, usual) else "",
            f"vs {self.stribeck_velocity:.2g} {unit}/s" if self.stribeck_velocity else "",
        )
        return ", ".join([*self.coefficients, *filter(None, settings)]) or "none"
