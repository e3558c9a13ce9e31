"""The core of the recursive estimator as C99: filters, regressor of a planar leg, R factors and their solution.

What it mirrors of :func:`exoid.online.advance`: ``filtered_rows`` for angles and torques, ``absorb`` without
forgetting, and ``current``: values, standard deviations and weights of :class:`exoid.online.State`. Intake, forgetting,
change detection and bounds are not mirrored.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from exoid._version import __version__
from exoid.codegen import Dialect
from exoid.codegen.constants import constants_of_bodies
from exoid.codegen.dialect import identifier
from exoid.codegen.forms import c_form
from exoid.codegen.templates import fill
from exoid.codegen.terms import torques_in_c
from exoid.errors import ExoidError
from exoid.files import write_together
from exoid.reduction.planar import GRAVITY
from exoid.tables import to_text
from exoid.torques import DryFriction, Term

from .estimator import RecursiveEstimator
from .intake import FARTHEST
from .rows import TOUCHED
from .settings import ROWS, Settings
from .solution import DETERMINED, FEWEST_ROWS, NOISELESS
from .state import STICKING, UNKNOWN

SCHEMA = "exoid-recursive-in-c-1"

ABSURD = 1e9
"""Torque [N·m] from which a sample is absurd, and limit of torque that stands for none."""

DOUBLE = Dialect("double")


@dataclass(frozen=True, eq=False, repr=False)
class RecursiveSource:
    """A recursive estimator in C; prints itself.

    Attributes:
        header: Text of the header.
        source: Text of the source.
        prefix: Prefix of every name in the files.
        settings: Settings of the estimator.
        path: Source that was written; None if none was.
    """

    header: str
    source: str
    prefix: str
    settings: Settings
    path: Path | None = None

    @property
    def functions(self) -> tuple[str, ...]:
        """Names of the functions for other files."""
        return tuple(f"{self.prefix}_{name}" for name in ("init", "update", "solve"))

    def to_json(self) -> dict[str, Any]:
        """Describe the files as JSON data.

        Returns:
            Names, hashes, functions, joints, parameters, rate, cut-off and estimator.
        """
        texts = {f"{self.prefix}.h": self.header, self.path.name if self.path else f"{self.prefix}.c": self.source}
        return {
            "schema": SCHEMA,
            "files": {name: hashlib.sha256(text.encode()).hexdigest() for name, text in texts.items()},
            "functions": list(self.functions),
            "joints": list(self.settings.model.leg.joint_names),
            "parameters": list(self.settings.model.names),
            "rate": self.settings.rate,
            "cutoff": self.settings.cutoff,
            "estimator": self.settings.estimator,
        }

    def __str__(self) -> str:
        """Print files, functions and what they estimate."""
        where, settings = self.path or Path(f"{self.prefix}.c"), self.settings
        return to_text(
            f"{where} and {where.with_name(f'{self.prefix}.h')}: recursive {settings.estimator} without forgetting",
            f"double precision, C99, needs <math.h> only; joints: {', '.join(settings.model.leg.joint_names)}",
            f"functions: {', '.join(self.functions)}, {settings.rate:g} times a second; cut-off {settings.cutoff} Hz",
            f"parameters: {', '.join(settings.model.names)}",
        )


def recursive_source(estimator: RecursiveEstimator, name: str = "online") -> RecursiveSource:
    """Turn the core of a recursive estimator into C99, in double precision, without writing files.

    The C begins with nothing; what the estimator has learnt is not written.

    Args:
        estimator: The estimator, of which the settings are written.
        name: Prefix of every name in C.

    Returns:
        Header and source.

    Raises:
        ExoidError: A setting, a term or the leg has no form in C: names it.

    Example:
        >>> data = exoid.datasets.bleex_swing()
        >>> online = RecursiveEstimator(data.leg, rate=100.0, cutoff=6.0, forgetting="none", false_alarms=0.0)
        >>> recursive_source(online).functions
        ('online_init', 'online_update', 'online_solve')
    """
    settings, prefix = estimator.settings, identifier(name)
    _refuse(settings, bool(estimator.state.information.R[-1].any()))
    values = {"p": prefix, "header": f"{prefix}.h", "version": __version__, **_values(settings)}
    header, source = (fill(f"recursive/recursive.{kind}.jinja", DOUBLE, **values) for kind in ("h", "c"))
    return RecursiveSource(header, source, prefix, settings)


def write_recursive(path: str | os.PathLike[str], estimator: RecursiveEstimator) -> RecursiveSource:
    """Write the core of a recursive estimator as a source and, beside it, a header.

    Args:
        path: Source to write, such as ``online.c``; the header is ``online.h``.
        estimator: The estimator, of which the settings are written.

    Returns:
        The texts that were written, with the file.

    Raises:
        ExoidError: As for :func:`recursive_source`, the file does not end in ``.c``, or it cannot be written.
    """
    if Path(path).suffix != ".c":
        raise ExoidError("a recursive estimator is a source and a header", where=str(path), remedy="name it ONLINE.c")
    written = recursive_source(estimator, Path(path).name)
    write_together({Path(path).with_name(f"{written.prefix}.h"): written.header, Path(path): written.source})
    return RecursiveSource(written.header, written.source, written.prefix, written.settings, Path(path))


def _refuse(settings: Settings, started: bool) -> None:
    """Refuse what is not mirrored, by name."""
    reasons = {
        f"forgetting={settings.forgetting!r} (use 'none')": settings.forgetting != "none",
        f"false_alarms={settings.false_alarms:g}, the change detection (use 0)": settings.false_alarms > 0.0,
        "cutoff=None (give a cut-off)": settings.cutoff is None,
        "nonnegative": settings.nonnegative,
        "consistent": settings.consistent,
        "an estimate to start with": started,
    }
    found = [reason for reason, given in reasons.items() if given]
    if found:
        raise ExoidError(f"the recursive estimator in C does not have: {'; '.join(found)}", remedy="leave it out")
    leg = settings.model.leg
    if leg.chain is None:
        raise ExoidError(
            "only a planar chain of revolute joints under gravity of 9.81 m/s² has closed equations to write in C",
            where=leg.description.name,
            remedy="choose joints whose axes are horizontal and parallel (joints=...)",
        )
    for block in settings.model.blocks:
        if type(block.term).usable not in (Term.usable, DryFriction.usable):
            raise ExoidError(
                f"{type(block.term).__name__} chooses samples by a rule of its own, which has no form in C",
                remedy="use Coulomb and Viscous friction",
            )


def _values(settings: Settings) -> dict[str, Any]:
    """Values of the templates."""
    model, leg = settings.model, settings.model.leg
    known = dict.fromkeys(leg.parameter_names, 0.0)
    tables = [table for table in constants_of_bodies(leg, known, DOUBLE) if table.name in ("sign", "dx", "dz")]
    dead = np.full(settings.n, -1.0)
    for block in model.blocks:
        if isinstance(block.term, DryFriction) and block.term.dead_band > 0.0:
            dead[list(block.joints)] = np.maximum(dead[list(block.joints)], block.term.dead_band)
    parameters, joints = (index.tolist() for index in settings.acting)
    return {
        "title": leg.description.name,
        "rate": settings.rate,
        "joints": leg.joint_names,
        "parameters": list(zip(model.names, model.units, strict=True)),
        "weighted": settings.estimator == "wls",
        "wide": settings.wide.smooth.tolist(),
        "first": settings.wide.first.tolist(),
        "second": settings.wide.second.tolist(),
        "narrow": settings.narrow.smooth.tolist(),
        "acting": list(zip(parameters, joints, strict=True)),
        "delay": settings.delay,
        "stride": settings.stride,
        "block_rows": ROWS,
        "gravity": GRAVITY,
        "cumulative": leg.cumulative,
        "tables": tables,
        "terms": list(_columns(settings)),
        "limits": np.minimum(settings.torque_limits, ABSURD).tolist(),
        "reversal": np.where(settings.sticking, settings.reversal_speed, 0.0).tolist(),
        "dead": dead.tolist(),
        "unknown": UNKNOWN,
        "sticking": STICKING,
        "touched": TOUCHED,
        "noiseless": NOISELESS,
        "fewest": float(FEWEST_ROWS),
        "determined": DETERMINED,
        "absurd": ABSURD,
        "farthest": FARTHEST,
    }


def _columns(settings: Settings) -> Iterator[tuple[int, int, str]]:
    """Parameter, joint and expression of each column of the terms: their torque for 1 of it and 0 of the others."""
    place = {name: index for index, name in enumerate(settings.model.names)}
    for block in settings.model.blocks:
        symbols = [
            (symbol, name) for symbol, name in zip(block.term.symbols, block.names, strict=True) if name in place
        ]
        for _, name in symbols:
            ones = {symbol: DOUBLE.number(float(other == name)) for symbol, other in symbols}
            for joint, torque in torques_in_c(block, ones, DOUBLE):
                rotor = c_form(block.term).place == "rotor"
                yield place[name], joint, f"{torque} * a[{joint}]" if rotor else torque
