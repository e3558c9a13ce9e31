"""Rows of the regression with the columns of every friction coefficient that is tried, formed once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.regression.rows import Prepared, form_rows, prepare
from exoid.signals import Recording, ZeroPhase
from exoid.torques import JointMotion, Motion, Presliding, Term, TorqueModel
from exoid.torques.catalog import radians
from exoid.torques.terms import REVERSAL, SLOW

from .patterns import Column, Columns, scaled


class Design(NamedTuple):
    """Rows of all recordings, sampled as sparsely as the filter allows."""

    recording: NDArray[np.intp]  # index of the recording of each row, (N,)
    time: FloatArray  # [s], (N,)
    moves: NDArray[np.bool_]  # where a joint does not rest; other rows of it are zero, (n, N)
    tau: FloatArray  # torques [N·m], (n, N)
    base: FloatArray  # columns of rigid bodies and armatures, (n, N, p)
    friction: tuple[FloatArray, ...]  # columns of the friction of each joint, n of (N, K)
    places: tuple[dict[Column, int], ...]  # index of each friction column of a joint, n of them
    independent_fraction: float  # share of the rows that carries independent noise
    gain: FloatArray  # what the filter makes of ones in all segments: rows fade towards their ends, (N,)
    known: Mapping[int, float] = MappingProxyType({})  # values of base parameters that are held, by their column

    def indices(self, joint: int, columns: Sequence[Column]) -> NDArray[np.intp]:
        """Indices of friction columns of a joint."""
        return np.array([self.places[joint][column] for column in columns], dtype=np.intp)

    def some(self, rows: NDArray[np.bool_]) -> Design:
        """Take some rows."""
        of_rows = {name: getattr(self, name)[rows] for name in ("recording", "time", "gain")}
        of_rows |= {name: getattr(self, name)[:, rows] for name in ("moves", "tau", "base")}
        return self._replace(**of_rows, friction=tuple(F[rows] for F in self.friction))


class _Library(NamedTuple):
    """Columns of every friction coefficient that is tried: column k of a joint is the k-th of its own."""

    terms: Sequence[Sequence[tuple[Term, str]]]  # of each joint: term and symbol of each column
    rigid: FloatArray | None  # parameters of the rigid bodies, whose torque loads the joints, (p,); None for no load

    @property
    def acting(self) -> NDArray[np.bool_]:
        """Columns that can act on each joint, (n, K)."""
        counts = np.array([len(of_joint) for of_joint in self.terms])
        return np.asarray(np.arange(counts.max()) < counts[:, None])

    @property
    def states(self) -> set[tuple[int, Presliding]]:
        """Internal states of the terms."""
        each = ((j, term.internal_state) for j, of_joint in enumerate(self.terms) for term, _ in of_joint)
        return {(j, state) for j, state in each if state is not None}

    def fill(self, motion: Motion, columns: FloatArray, out: FloatArray) -> None:
        """Write the columns."""
        load = np.zeros(columns.shape[1:])
        if self.rigid is not None:
            load = np.tensordot(self.rigid, columns[: len(self.rigid)], axes=1)
            load += 0.0 if motion.payload is None else motion.payload.T
        for j, of_joint in enumerate(self.terms):
            for (term, symbol), place in zip(of_joint, out[:, j], strict=False):  # other joints may have more
                kind, every = term.internal_state, np.zeros((len(term.symbols), len(motion.q)))
                state = None if kind is None else motion.states[j, kind]
                term.fill(JointMotion(motion.q[:, j], motion.v[:, j], motion.a[:, j], load[j], state), every)
                place[:] = every[term.symbols.index(symbol)]


def form_design(
    model: TorqueModel,
    recordings: Sequence[Recording],
    cutoff: float,
    library: Sequence[Columns],
    rigid: FloatArray | None = None,
) -> Design:
    """Form the rows of a fit in one pass over the samples."""
    # No row is left out at reversals, unlike the default of a fit: only there does presliding differ from sharp
    # friction.
    unit, parts = radians(model.leg), list[Design]()
    terms = [[(scaled(c.term, x), c.symbol) for c in of_one] for of_one, x in zip(library, unit.tolist(), strict=True)]
    wide, count = replace(model, extras=(_Library(terms, rigid),)), len(model.names)
    prepared = [prepare(wide, each, ZeroPhase(cutoff), stops=False) for each in recordings]
    step = max(1, -(-sum(len(each.rows) for each in prepared) // 8000))  # beyond so many rows, fewer are kept
    for index, full in enumerate(prepared):
        each = full._replace(rows=full.rows[(len(full.rows) - 1) % step // 2 :: step])
        of_recording = ~_rests(each, unit)
        for stretch in each.stretches():
            rows, where = form_rows(wide, each, stretch), slice(stretch.start, stretch.stop, stretch.step)
            moves, at = of_recording[where].T, np.full(len(stretch), index, dtype=np.intp)
            W = rows.W.transpose(1, 0, 2) * moves[..., None]
            friction = tuple(W[j, :, count : count + len(of_joint)] for j, of_joint in enumerate(library))
            assert each.parallel is not None  # that of the cut-off
            tau, base, gain = rows.tau.T * moves, W[..., :count], each.parallel.gain(each.inside, stretch)
            part = Design(at, rows.time, moves, tau, base, friction, (), 1.0, gain)
            parts.append(part.some(each.inside[where]))
    recording, time, gain = map(np.concatenate, zip(*((x.recording, x.time, x.gain) for x in parts), strict=True))
    moves, tau, base = (np.concatenate(x, axis=1) for x in zip(*((x.moves, x.tau, x.base) for x in parts), strict=True))
    friction = tuple(np.vstack([part.friction[joint] for part in parts]) for joint in range(len(library)))
    places = tuple({column: k for k, column in enumerate(of_joint)} for of_joint in library)
    share = min(1.0, float(np.mean([each.independent_fraction for each in prepared])) * step)
    return Design(recording, time, moves, tau, base, friction, places, share, gain)


def _rests(prepared: Prepared, unit: FloatArray) -> NDArray[np.bool_]:
    """Select samples at which a joint rests, slower than at a reversal for at least 0.3 s, (N, n)."""
    # What holds a joint at rest is anything between -c0 and c0: any form that fits it has learnt noise. That time was
    # chosen by seeds below 100 of the proving ground.
    v, count = prepared.motion.v, max(2, round(0.3 / float(np.median(np.diff(prepared.time)))))
    slow = np.abs(v) <= np.minimum(REVERSAL * unit, SLOW * np.sqrt(np.mean(v**2, axis=0)))
    return np.asarray(scipy.ndimage.binary_opening(slow, np.ones((count, 1), dtype=np.bool_)))
