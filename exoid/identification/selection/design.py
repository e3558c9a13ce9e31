"""Rows of the regression with the columns of every friction coefficient that is tried, formed once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.regression.rows import Prepared, prepare
from exoid.signals import Recording, ZeroPhase
from exoid.torques import JointMotion, Motion, Presliding, TorqueModel
from exoid.torques.catalog import USUAL
from exoid.torques.terms import SLOW

from .patterns import Column, Columns


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
        return self._replace(
            recording=self.recording[rows],
            time=self.time[rows],
            moves=self.moves[:, rows],
            tau=self.tau[:, rows],
            base=self.base[:, rows],
            friction=tuple(F[rows] for F in self.friction),
            gain=self.gain[rows],
        )


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
    prepared = [prepare(model, each, ZeroPhase(cutoff)) for each in recordings]
    step = max(1, -(-sum(len(each.rows) for each in prepared) // 8000))  # beyond so many rows, fewer are kept
    parts: list[Design] = []
    for index, full in enumerate(prepared):
        each = full._replace(rows=full.rows[(len(full.rows) - 1) % step // 2 :: step])
        motion, moves = each.motion, ~_rests(each)
        needed = {(j, column.term.internal_state) for j, of_joint in enumerate(library) for column in of_joint}
        states = {(j, state): state.states(motion.q[:, j], motion.v[:, j]) for j, state in needed if state is not None}
        for stretch in each.stretches():
            part = _form(model, each, stretch, library, states, rigid, moves)
            mask = each.inside[stretch.start : stretch.stop : stretch.step]
            parts.append(part._replace(recording=np.full(len(mask), index, dtype=np.intp)).some(mask))
    return Design(
        np.concatenate([part.recording for part in parts]),
        np.concatenate([part.time for part in parts]),
        np.hstack([part.moves for part in parts]),
        np.hstack([part.tau for part in parts]),
        np.concatenate([part.base for part in parts], axis=1),
        tuple(np.vstack([part.friction[joint] for part in parts]) for joint in range(len(library))),
        tuple({column: k for k, column in enumerate(of_joint)} for of_joint in library),
        min(1.0, float(np.mean([each.independent_fraction for each in prepared])) * step),
        np.concatenate([part.gain for part in parts]),
    )


def _rests(prepared: Prepared) -> NDArray[np.bool_]:
    """Select samples at which a joint rests, slower than at a reversal for at least 0.3 s, (N, n)."""
    # What holds a joint at rest is anything between -c0 and c0: any form that fits it has learnt noise. That time was
    # chosen by seeds below 100 of the proving ground.
    v, count = prepared.motion.v, max(2, round(0.3 / float(np.median(np.diff(prepared.time)))))
    slow = np.abs(v) <= np.minimum(USUAL.reversal_speed, SLOW * np.sqrt(np.mean(v**2, axis=0)))
    return np.asarray(scipy.ndimage.binary_opening(slow, np.ones((count, 1), dtype=np.bool_)))


def _form(
    model: TorqueModel,
    prepared: Prepared,
    stretch: range,
    library: Sequence[Columns],
    states: dict[tuple[int, Presliding], FloatArray],
    rigid: FloatArray | None,
    moves: NDArray[np.bool_],
) -> Design:
    """Form a stretch of rows, joint by joint."""
    around = slice(max(0, stretch[0] - prepared.reach), stretch[-1] + 1 + prepared.reach)
    inside = range(stretch[0] - around.start, stretch[-1] + 1 - around.start, stretch.step)
    motion: Motion = prepared.motion.rows(around)
    columns = model.columns(motion)
    load = np.zeros(columns.shape[1:]) if rigid is None else np.tensordot(rigid, columns[: len(rigid)], axes=1)
    if rigid is not None and motion.payload is not None:
        load += motion.payload.T
    counted = prepared.inside[around]
    gain = np.ones(len(inside))
    if prepared.parallel is not None:
        ones = prepared.parallel.among_zeros(counted[None].astype(np.float64), inside)[0]
        gain = np.where(counted[inside.start : inside.stop : inside.step], ones, 1.0)
    base, friction = np.zeros((columns.shape[1], len(inside), len(columns))), []
    tau, rows = np.zeros((columns.shape[1], len(inside))), slice(stretch.start, stretch.stop, stretch.step)
    for joint, of_joint in enumerate(library):
        acting = np.flatnonzero(model.acting[joint])
        extra = []
        for term, symbol in ((column.term, column.symbol) for column in of_joint):
            state = None if term.internal_state is None else states[joint, term.internal_state][around]
            both = np.zeros((len(term.symbols), len(motion.q)))
            term.fill(JointMotion(motion.q[:, joint], motion.v[:, joint], motion.a[:, joint], load[joint], state), both)
            extra.append(both[term.symbols.index(symbol)])
        signals = np.vstack([columns[acting, joint], *extra, prepared.tau[around, joint]])
        if prepared.parallel is None:
            filtered = signals[:, inside.start : inside.stop : inside.step]
        else:
            filtered = prepared.parallel.among_zeros(signals, inside, counted)
        filtered = filtered * moves[rows, joint]
        base[joint][:, acting] = filtered[: len(acting)].T
        friction.append(filtered[len(acting) : -1].T)
        tau[joint] = filtered[-1]
    of_all = np.zeros(len(inside), dtype=np.intp)
    return Design(of_all, prepared.time[rows], moves[rows].T, tau, base, tuple(friction), (), 1.0, gain)
