"""The whole torque of a leg: rigid-body dynamics and the terms beside it, linear in one vector of parameters."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError
from exoid.leg import Leg
from exoid.torso import TorsoMotion

from .term import Term

BLOCK = 8192
"""Samples worked on at once."""

DEPENDENT = 1e-9
"""A unit column this close to the span of those before it is dependent on them."""


class Merged(NamedTuple):
    """A parameter that no motion can tell from others, and therefore became part of them.

    Attributes:
        name: The parameter.
        into: Names of the parameters that contain it, with its share in each.
    """

    name: str
    into: dict[str, float]

    def __str__(self) -> str:
        """Say it in words."""
        share = ", ".join(n if abs(c - 1.0) < 1e-6 else f"{n} (× {c:.3g})" for n, c in self.into.items())
        return f"{self.name} cannot be told from {share} by any motion: it is part of it"


class _Block(NamedTuple):
    """One term at one joint."""

    term: Term
    joint: int
    names: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class TorqueModel:
    """τ = W(q, v, a) β with β = (leg parameters, term parameters).

    Attributes:
        leg: The rigid bodies.
        terms: What acts on the joints besides.
    """

    leg: Leg
    terms: tuple[Term, ...]

    def __post_init__(self) -> None:
        """Check that each parameter has one name."""
        names = [*self.leg.parameter_names, *(name for block in self._blocks for name in block.names)]
        repeated = sorted({name for name in names if names.count(name) > 1})
        if repeated:
            raise ExoidError(f"parameters occur twice: {', '.join(repeated)}", remedy="give each term once a joint")

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all parameters, in the order of the columns."""
        return tuple(self._units)

    @property
    def units(self) -> tuple[str, ...]:
        """Their units."""
        return tuple(self._units.values())

    @cached_property
    def merged(self) -> tuple[Merged, ...]:
        """Parameters of terms that are part of others, whatever the motion (a rotor at the hip is part of J1)."""
        every = (*self.leg.parameter_names, *(name for block in self._blocks for name in block.names))
        rng = np.random.default_rng(0)
        motion = rng.standard_normal((3, 10 * len(every), len(self.leg.joint_names)))
        q, v, a = motion * [[[1.0]], [[2.0]], [[5.0]]]
        W = self._fill(q, v, a, None, every).reshape(-1, len(every))
        scale = np.linalg.norm(W, axis=0)
        scale = np.where(scale > 0.0, scale, 1.0)
        W = np.asarray(np.linalg.qr(W / scale, mode="r"))  # as small as can be: a seven-joint arm has 80 columns
        kept, merged = list(range(len(self.leg.parameter_names))), []
        for k in range(len(kept), len(every)):
            share, *_ = np.linalg.lstsq(W[:, kept], W[:, k])
            if W[:, k].any() and np.linalg.norm(W[:, k] - W[:, kept] @ share) < DEPENDENT:
                shares = zip(kept, share * scale[k] / scale[kept], strict=True)
                merged.append(Merged(every[k], {every[i]: float(s) for i, s in shares if abs(s) > DEPENDENT}))
            else:
                kept.append(k)
        return tuple(merged)

    def regressor(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, torso: TorsoMotion | None = None) -> FloatArray:
        """Columns of all parameters, (N, n, P); arguments as for :meth:`exoid.Leg.regressor`."""
        q, v, a = self.leg.samples(q, v, a)
        return self._fill(q, v, a, torso, self.names)

    def usable(self, v: FloatArray) -> NDArray[np.bool_]:
        """Say which joint's sample can be identified from, given velocities [rad/s], (N, n)."""
        usable = np.ones(v.shape, dtype=np.bool_)
        for term, joint, _ in self._blocks:
            usable[:, joint] &= term.usable(v[:, joint])
        return usable

    @cached_property
    def _blocks(self) -> tuple[_Block, ...]:
        names, labels = self.leg.joint_names, self.leg.joint_labels
        return tuple(
            _Block(term, joint, tuple(f"{symbol}_{labels[joint]}" for symbol in term.symbols))
            for term in self.terms
            for joint in term.joint_indices(names, labels)
        )

    @cached_property
    def _units(self) -> dict[str, str]:
        units = dict(zip(self.leg.parameter_names, self.leg.parameter_units, strict=True))
        for block in self._blocks:
            units.update(zip(block.names, block.term.units, strict=True))
        for merged in self.merged:
            del units[merged.name]
        return units

    def _fill(
        self, q: FloatArray, v: FloatArray, a: FloatArray, torso: TorsoMotion | None, names: tuple[str, ...]
    ) -> FloatArray:
        """Regressor of the named parameters, of which the leg's are the first."""
        out = np.zeros((len(names), *q.shape[::-1]))
        self.leg.fill_regressor(q, v, a, out[: len(self.leg.parameter_names)], torso)
        for start in range(0, len(q), BLOCK):
            rows = slice(start, start + BLOCK)
            columns = out[len(self.leg.parameter_names) :, :, rows]
            self._fill_terms(q[rows].T, v[rows].T, a[rows].T, columns, names)
        return out.transpose(2, 1, 0)

    def _fill_terms(self, q: FloatArray, v: FloatArray, a: FloatArray, out: FloatArray, names: tuple[str, ...]) -> None:
        row = 0
        for term, joint, symbols in self._blocks:
            kept = [k for k, name in enumerate(symbols) if name in names]
            rows = slice(row, row + len(kept))
            columns = out[rows, joint] if len(kept) == len(symbols) else np.zeros((len(symbols), q.shape[1]))
            term.fill(q[joint], v[joint], a[joint], columns)
            if len(kept) < len(symbols):
                out[rows, joint] = columns[kept]
            row = rows.stop
