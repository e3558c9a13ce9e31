"""The recursive estimator as C99: filters, regressor of a planar leg, R factors, forgetting and change detection.

It mirrors :func:`exoid.online.advance` for angles and torques: rows behind the filters, forgetting, change detection,
and values, standard deviations and weights of :class:`exoid.online.State`. Intake, the intervals of an estimate, and
bounds are not mirrored. The work on a block is cut into units, which the samples of the next block share.
"""

from __future__ import annotations

import hashlib
import math
import os
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from itertools import count
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from exoid._version import __version__
from exoid.codegen import Dialect
from exoid.codegen.arrays import initializer
from exoid.codegen.constants import constants_of_bodies
from exoid.codegen.dialect import identifier
from exoid.codegen.forms import c_form
from exoid.codegen.templates import fill
from exoid.codegen.terms import torques_in_c
from exoid.errors import ExoidError
from exoid.leg.reduction.planar import GRAVITY
from exoid.tools.files import write_together
from exoid.tools.tables import to_text
from exoid.torques import DryFriction, Term

from .advance import CHECKPOINT, FREED, SETTLED
from .correlation import FEWEST, MEMORY, NEGLIGIBLE
from .detection import CLIPPED, DECISION, LEVEL, PENALTY, SETTLING, SLOWLY, WARM_UP, Detection
from .detection import RIDGE as RIDGE_OF_TEST
from .estimator import RecursiveEstimator
from .information import EXCITED, EXCITED_BLOCK, RIDGE, ROUNDING
from .intake import FARTHEST
from .rows import TOUCHED
from .settings import LAGS, ROWS, Settings
from .solution import DETERMINED, FEWEST_ROWS, NOISELESS
from .state import CHECKPOINTS, STICKING, UNKNOWN, State

SCHEMA = "exoid-recursive-in-c-1"

ABSURD = 1e9
"""Torque [N·m] from which a sample is absurd, and limit of torque that stands for none."""

SWEEPS = 5
"""Largest number of sweeps of one-sided Jacobi; convergence is quadratic, and three to five are enough."""

AT_ONCE = 4
"""Columns of new rows that a unit of work takes in."""

DOUBLE = Dialect("double")


@dataclass(frozen=True, eq=False, repr=False)
class RecursiveSource:
    """A recursive estimator in C; prints itself."""

    header: str  # text of the header
    source: str  # text of the source
    prefix: str  # prefix of every name in the files
    settings: Settings  # settings of the estimator
    path: Path | None = None  # source that was written; None if none was

    @property
    def functions(self) -> tuple[str, ...]:
        """Names of the functions for other files."""
        return tuple(f"{self.prefix}_{name}" for name in ("init", "update", "solve"))

    def to_json(self) -> dict[str, Any]:
        """Describe the files as JSON data."""
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
            "forgetting": self.settings.forgetting,
            "false_alarms": self.settings.false_alarms if detects(self.settings) else 0.0,
        }

    def __str__(self) -> str:
        """Print files, functions and what they estimate."""
        where, settings = self.path or Path(f"{self.prefix}.c"), self.settings
        return to_text(
            f"{where} and {where.with_name(f'{self.prefix}.h')}: recursive {settings.estimator}",
            forgets(settings),
            f"double precision, C99, needs <math.h> only; joints: {', '.join(settings.model.leg.joint_names)}",
            f"functions: {', '.join(self.functions)}, {settings.rate:g} times a second; cut-off {settings.cutoff} Hz",
            f"parameters: {', '.join(settings.model.names)}",
        )


def recursive_source(estimator: RecursiveEstimator, name: str = "online") -> RecursiveSource:
    """Turn a recursive estimator into C99, in double precision, without writing files."""
    # The C begins with the start of the estimator, or with nothing; what it has learnt since is not written.
    settings, prefix = estimator.settings, identifier(name)
    _refuse(settings, estimator.state)
    values = {"p": prefix, "header": f"{prefix}.h", "version": __version__, **_values(settings, estimator.state)}
    header, source = (fill(f"recursive/recursive.{kind}.jinja", DOUBLE, **values) for kind in ("h", "c"))
    return RecursiveSource(header, source, prefix, settings)


def write_recursive(path: str | os.PathLike[str], estimator: RecursiveEstimator) -> RecursiveSource:
    """Write the core of a recursive estimator as a source and, beside it, a header."""
    if Path(path).suffix != ".c":
        raise ExoidError("a recursive estimator is a source and a header", where=str(path), remedy="name it ONLINE.c")
    written = recursive_source(estimator, Path(path).name)
    write_together({Path(path).with_name(f"{written.prefix}.h"): written.header, Path(path): written.source})
    return RecursiveSource(written.header, written.source, written.prefix, written.settings, Path(path))


def _refuse(settings: Settings, state: State) -> None:
    """Refuse what is not mirrored, by name."""
    reasons = {
        "cutoff=None (give a cut-off)": settings.cutoff is None,
        "nonnegative": settings.nonnegative,
        "consistent": settings.consistent,
        "what a start and samples gave (write it before the first sample)": bool(
            state.samples and state.information.R[-1].any()
        ),
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


def detects(settings: Settings) -> bool:
    """Say whether changes are detected."""
    return settings.false_alarms > 0.0 and settings.forgetting != "none"


def forgets(settings: Settings) -> str:
    """Say in words how rows are forgotten."""
    if settings.forgetting == "none":
        return "rows are never forgotten"
    where = "in the directions that new rows excite" if settings.forgetting == "directional" else "while rows excite"
    return f"rows are forgotten {where}, with a time constant of {settings.memory:g} s"


def _values(settings: Settings, state: State) -> dict[str, Any]:
    """Values of the templates."""
    model, leg = settings.model, settings.model.leg
    known = dict.fromkeys(leg.parameter_names, 0.0)
    tables = [table for table in constants_of_bodies(leg, known, DOUBLE) if table.name in ("sign", "dx", "dz")]
    dead = np.full(settings.n, -1.0)
    for block in model.blocks:
        if isinstance(block.term, DryFriction) and block.term.dead_band > 0.0:
            dead[list(block.joints)] = np.maximum(dead[list(block.joints)], block.term.dead_band)
    parameters, joints = settings.acting
    started = bool(state.information.R[-1].any())
    prior = started or detects(settings)
    return {
        "initial": partial(initializer, dialect=DOUBLE),
        "title": leg.description.name,
        "rate": settings.rate,
        "joints": leg.joint_names,
        "n_joints": settings.n,
        "parameters": list(zip(model.names, model.units, strict=True)),
        "weighted": settings.estimator == "wls",
        "forgetting": settings.forgetting,
        "forgets": forgets(settings)[0].upper() + forgets(settings)[1:],
        "wide": np.array([settings.wide.smooth, settings.wide.first, settings.wide.second]),
        "narrow": settings.narrow.smooth,
        "joints_of_columns": joints,
        "parameters_of_columns": parameters,
        "delay": settings.delay,
        "stride": settings.stride,
        "block": settings.block,
        "block_rows": ROWS,
        "block_time": settings.block_time,
        "work": Work.of(settings),
        "at_once": AT_ONCE,
        "gravity": GRAVITY,
        "cumulative": leg.cumulative,
        "tables": tables,
        "terms": list(_columns(settings)),
        "limits": np.minimum(settings.torque_limits, ABSURD),
        "reversal": np.where(settings.sticking, settings.reversal_speed, 0.0),
        "dead": dead,
        "rounding": ROUNDING,
        "unknown": UNKNOWN,
        "sticking": STICKING,
        "touched": TOUCHED,
        "noiseless": NOISELESS,
        "fewest": float(FEWEST_ROWS),
        "determined": DETERMINED,
        "absurd": ABSURD,
        "farthest": FARTHEST,
        "started": started,
        "start": _start(state),
        "prior": prior,
        "correlated": prior,
        **_of_correlation(settings),
        **_of_forgetting(settings),
        **(_of_detection(settings) if detects(settings) else {"detection": False}),
    }


def _start(state: State) -> dict[str, Any]:
    """What is known before the first row."""
    information = state.information
    return {
        "R": information.R[-1] * np.where(np.diag(information.R[-1]) < 0.0, -1.0, 1.0)[:, None],
        "count": float(information.rows[-1]),
        "values": state.values,
        "std": state.std,
        "weights": state.weights,
    }


def _of_correlation(settings: Settings) -> dict[str, Any]:
    """Constants of the autocorrelation of residuals."""
    return {
        "lags": LAGS,
        "negligible": NEGLIGIBLE,
        "fewest_pairs": FEWEST,
        "filter_inflation": settings.filter_inflation,
        "discount_of_pairs": float(np.exp(-ROWS * settings.row_time / MEMORY)),
    }


def _of_forgetting(settings: Settings) -> dict[str, Any]:
    """Constants of the forgetting."""
    return {
        "shares": 1.0 - np.exp(-np.arange(ROWS + 1.0) * settings.row_time / settings.memory),
        "excited": EXCITED,
        "excited_block": EXCITED_BLOCK,
        "ridge": RIDGE,
        "sweeps": SWEEPS,
    }


def _of_detection(settings: Settings) -> dict[str, Any]:
    """Constants of the change detection."""
    found, K = Detection.of(settings), settings.count
    over = settings.block_time / settings.window
    places = np.zeros((len(found.hypotheses), K), dtype=np.int64)
    touched, bases = [], []
    for row, one in zip(places, found.hypotheses, strict=True):
        acting = np.flatnonzero(one.basis.any(axis=1))
        row[: len(acting)] = acting
        touched.append(len(acting))
        bases.append(np.hstack([one.basis, np.linalg.svd(one.basis)[0][:, one.basis.shape[1] :]]))
    return {
        "detection": True,
        "false_alarms": settings.false_alarms,
        "hypotheses": found.hypotheses,
        "change": {
            "limits": found.limits,
            "dimensions": found.dimensions,
            "touched": np.array(touched),
            "places": places,
            "bases": np.array(bases),
            "widest": int(found.dimensions.max()),
        },
        "kept": CHECKPOINTS,
        "settled_rows": SETTLED * K,
        "checkpoint_blocks": max(1, round(CHECKPOINT / over)),
        "last_crossing": next(k for k in count() if (k + 1) * settings.block_time > DECISION * settings.window),
        "discount": math.exp(-over),
        "slow_discount": math.exp(-over / LEVEL),
        "slow_part": over / SLOWLY,
        "block_over_window": over,
        "settling": SETTLING,
        "warm_up": WARM_UP,
        "clip": CLIPPED,
        "penalty": PENALTY,
        "ridge_of_test": RIDGE_OF_TEST,
        "freed": FREED,
    }


class Work(NamedTuple):
    """What a sample has to do of the work after a block, in multiplications or so, as the units in C count it."""

    plain: int  # without an R factor of what was known before the rows
    prior: int  # with one
    change: int  # in a block in which a change is confirmed

    @classmethod
    def of(cls, settings: Settings) -> Work:
        """Share the work among the samples of the next block that form no row."""
        calls = settings.block - ROWS if settings.stride > 1 else settings.block
        look = _work_of_looking(settings)
        plain, prior = (look + _work_of_rows(settings, before) for before in (False, True))
        least = max(1, calls - 1 - math.ceil(look * calls / plain))  # calls after the decision
        change = prior + _work_of_change(settings)
        return cls(*(math.ceil(total) for total in (plain / calls, prior / calls, change / least)))


def _work_of_solving(settings: Settings, slots: int) -> float:
    """Common R factor of several, its values and standard deviations."""
    n, K, column = settings.n, settings.count, np.arange(settings.count)
    stack = slots * K * K / 2 + (2 * (K - column + 8) * (slots * (column + 1) + 1) + 150).sum()
    return float(stack + K * K + (column**2 / 2 + 20 * column + 50).sum() + n * K * K)


def _work_of_rows(settings: Settings, prior: bool) -> float:
    """Forgetting, taking rows in, solving, and following the residuals."""
    n, K = settings.n, settings.count
    absorb = sum(AT_ONCE * (2 * (K - first + 8) * (ROWS + 1) + 100) for first in range(0, K + 1, AT_ONCE))
    total = 60.0 * n + n * absorb + _work_of_solving(settings, n + 1) + 2 * ROWS * LAGS * n + (n + 1) * K * K
    for height in [ROWS] * n + [n * ROWS] * prior:
        if settings.forgetting != "none":
            total += height * (K * K / 2 + 17 * K) + K * K / 2
        if settings.forgetting == "directional":
            total += SWEEPS * (height * (height - 1) / 2 * (5 * K + 50) + height * K)
            total += height * (2 * K * K + 2 * K * height + 20 * K)
    return total


def _work_of_looking(settings: Settings) -> float:
    """Statistics of the change detection."""
    if not detects(settings):
        return 0.0
    sizes = [(np.count_nonzero(one.basis.any(axis=1)), one.basis.shape[1]) for one in Detection.of(settings).hypotheses]
    tests = sum(2 * rows**2 * d + rows * d * d + 150 * d for rows, d in sizes)
    return float(2 * ROWS * settings.n * settings.count**2 + tests + 20 * len(sizes))


def _work_of_change(settings: Settings) -> float:
    """Forgetting the parameters that changed, and solving again."""
    if not detects(settings):
        return 0.0
    n, K, column = settings.n, settings.count, np.arange(settings.count)
    turned = K * (column + 5).sum() + (6 * (K - column + 8) * (K - column) + 450).sum()
    copied = (1 + CHECKPOINTS) * (n + 1) * K * K
    return float(turned + K**3 + (n + 2) * K * K + copied + 2 * _work_of_solving(settings, n + 1))


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
