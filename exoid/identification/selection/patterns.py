"""Friction models of one joint that are compared: which coefficients they have, at which settings, and an offset."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.torques import Coulomb, LoadFriction, Offset, Stribeck, Term, Viscous
from exoid.torques.terms import DryFriction

SHARP = 0.0
"""Presliding length of friction without presliding."""

DRY = ("c0", "mu", "mu_drive", "mu_back", "cs")
"""Symbols of dry friction, which may have presliding."""

LENGTHS = (3e-4, 6e-4, 1.2e-3, 2.5e-3, 5e-3, 0.01, 0.02)
"""Presliding lengths that are tried [rad]."""

VELOCITIES = (0.02, 0.03, 0.06, 0.085, 0.12, 0.17, 0.25, 0.35, 0.5)
"""Stribeck velocities that are tried [rad/s]. A model whose best velocity is the first describes the smoothing at
reversals and loses; the last is an upper bound. Beyond, it is no matter of slow motion."""

SMOOTHING, REVERSAL_SPEED = 0.015, 0.03
"""Settings of friction without presliding [rad/s], as of the default terms: the last fit leaves out its reversals."""

SMOOTHINGS = (0.004, 0.008, SMOOTHING, 0.03)
"""Smoothings of friction without presliding that are tried [rad/s]."""

WIDER = 2.0
"""A Stribeck velocity is at least this multiple of the smoothing, which hides it otherwise."""

FINER = (1.18, 1.06, 1.02)
"""Factor between settings about one that was chosen, sweep by sweep; two are added to each side."""


class Column(NamedTuple):
    """One coefficient at given settings.

    Attributes:
        symbol: Symbol of the coefficient: c0, d, mu, mu_drive, mu_back, cs, or offset.
        length: Presliding length [rad]; 0 for none.
        velocity: Stribeck velocity [rad/s]; 0 for other friction.
        smoothing: Velocity over which dry friction without presliding changes sign [rad/s].
    """

    symbol: str
    length: float = SHARP
    velocity: float = 0.0
    smoothing: float = SMOOTHING

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
        if self.length != SHARP:
            return replace(kinds[self.symbol], presliding=self.length)
        return replace(kinds[self.symbol], smoothing=self.smoothing, reversal_speed=REVERSAL_SPEED)


PLAIN = (Column("c0"), Column("d"), Column("offset"))
"""Where the search begins, and what a choice is compared with."""


class Pattern(NamedTuple):
    """Coefficients that a friction model has, whatever their settings."""

    # All coefficients but the offset are positive: then friction dissipates at every speed and under every load.

    symbols: tuple[str, ...]  # symbols of the coefficients
    presliding: bool  # whether dry friction has presliding

    @property
    def numbers(self) -> int:
        """Number of coefficients and settings; smoothing is none, as the last fit leaves out where it matters."""
        return len(self.symbols) + self.presliding + ("cs" in self.symbols)

    @property
    def complexity(self) -> float:
        """Number of numbers; friction under load in one direction of power only counts half a number more."""
        return self.numbers + 0.5 * ("mu_back" in self.symbols and "mu_drive" not in self.symbols)

    def dissipative(self, coefficients: FloatArray) -> NDArray[np.bool_]:
        """Say which sets of coefficients are positive, as friction that dissipates is."""
        signed = [symbol != "offset" for symbol in self.symbols]
        return np.asarray((coefficients[:, signed] > 0.0).all(axis=1))

    def within(self, other: Pattern) -> bool:
        """Say whether another pattern can be this one, with coefficients that are zero or equal."""
        load = {"mu"} if {"mu_drive", "mu_back"} <= set(other.symbols) else set()
        return {*self.symbols} <= {*other.symbols, *load} and (other.presliding or not self.presliding)

    def columns(self, length: float, velocity: float, smoothing: float = SMOOTHING) -> tuple[Column, ...]:
        """Coefficients at settings."""
        length, smoothing = (length, SMOOTHING) if self.presliding else (SHARP, smoothing)
        dry = (length, 0.0, smoothing), (length, velocity, smoothing)
        return tuple(
            Column(symbol, *dry[symbol == "cs"]) if symbol in DRY else Column(symbol) for symbol in self.symbols
        )


class Grid(NamedTuple):
    """Settings that are tried for one joint."""

    lengths: tuple[float, ...] = LENGTHS  # presliding lengths [rad]
    velocities: tuple[float, ...] = VELOCITIES  # stribeck velocities [rad/s]
    smoothings: tuple[float, ...] = SMOOTHINGS  # smoothings of friction without presliding [rad/s]

    @property
    def columns(self) -> tuple[Column, ...]:
        """All coefficients at all settings."""
        every = [Pattern((symbol,), bent) for symbol in ("d", "offset", *DRY) for bent in (False, True)]
        return tuple(dict.fromkeys(columns[0] for pattern in every for columns in self.settings(pattern)))

    def settings(self, pattern: Pattern) -> list[tuple[Column, ...]]:
        """List a pattern at all settings that it has."""
        dry = bool({*DRY} & {*pattern.symbols})
        lengths = self.lengths if pattern.presliding else (SHARP,)
        smoothings = self.smoothings if dry and not pattern.presliding else (SMOOTHING,)
        velocities = self.velocities if "cs" in pattern.symbols else (0.0,)
        return [
            pattern.columns(length, velocity, smoothing)
            for length, velocity, smoothing in itertools.product(lengths, velocities, smoothings)
            if length or not velocity or velocity >= WIDER * smoothing
        ]

    def about(self, columns: tuple[Column, ...], sweep: int) -> Grid:
        """Add finer settings about those of a choice."""
        factors = [FINER[min(sweep, len(FINER)) - 1] ** power for power in (-2, -1, 0, 1, 2)]
        lengths = {factor * column.length for column in columns if column.length for factor in factors}
        velocities = {factor * column.velocity for column in columns if column.velocity for factor in factors}
        sharp = {column.smoothing for column in columns if column.symbol in DRY and not column.length}
        smoothings = {factor * smoothing for smoothing in sharp for factor in factors}
        slow = {velocity for velocity in velocities if VELOCITIES[0] <= velocity <= VELOCITIES[-1]}
        return Grid(
            tuple(sorted({*self.lengths, *lengths})),
            tuple(sorted({*self.velocities, *slow})),
            tuple(sorted({*self.smoothings, *smoothings})),
        )


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


def terms_of(columns: tuple[Column, ...], joint: str) -> tuple[Term, ...]:
    """Terms of a joint, in the order of their coefficients."""
    return tuple(replace(term, joints=(joint,)) for term in dict.fromkeys(column.term for column in columns))


def absent(columns: tuple[Column, ...]) -> tuple[Column, ...]:
    """Coulomb and viscous friction that a choice leaves out: an estimate, and a URDF, has them as zero."""
    like = next((column for column in columns if column.symbol in DRY), Column("c0"))
    plain = (Column("c0", like.length, smoothing=like.smoothing), Column("d"))
    return tuple(column for column in plain if column.symbol not in {each.symbol for each in columns})


def zeros_of(columns: tuple[Column, ...], label: str) -> tuple[str, ...]:
    """Names of coefficients that the terms have and the choice leaves out."""
    present = {column.symbol for column in columns}
    symbols = dict.fromkeys(symbol for column in columns for symbol in column.term.symbols)
    return tuple(f"{symbol}_{label}" for symbol in symbols if symbol not in present)


def describe(columns: tuple[Column, ...]) -> str:
    """Write a friction model in a few words, such as "c0, mu_back, presliding 0.65 mrad"."""
    if not columns:
        return "none"
    parts = [column.symbol for column in columns]
    parts += [f"presliding {1e3 * length:.2g} mrad" for length in {c.length for c in columns} if length]
    parts += [f"smoothing {width:.2g} rad/s" for width in {c.smoothing for c in columns} if width != SMOOTHING]
    parts += [f"vs {velocity:.2g} rad/s" for velocity in {c.velocity for c in columns} if velocity]
    return ", ".join(parts)
