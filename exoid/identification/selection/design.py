"""Rows of the regression with the columns of every friction coefficient that is tried, formed once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.identification.group_rows import Keep
from exoid.leg.leg import Leg
from exoid.regression.rows import Prepared, prepare
from exoid.signals import Preparation, Recording
from exoid.torques import Armature, InternalState, JointMotion, Motion, Term, TorqueModel

from .patterns import Column

ROWS = 8000
"""Rows of all recordings at most; beyond, fewer are kept."""


class Design(NamedTuple):
    """Rows of all recordings, sampled as sparsely as the filter allows."""

    recording: NDArray[np.intp]  # index of the recording of each row, (N,)
    time: FloatArray  # [s], (N,)
    v: FloatArray  # velocities [rad/s], (N, n)
    tau: FloatArray  # torques [N·m], (n, N)
    base: FloatArray  # columns of rigid bodies and armatures, (n, N, p)
    friction: tuple[FloatArray, ...]  # columns of the friction of each joint, n of (N, K)
    places: tuple[dict[Column, int], ...]  # index of each friction column of a joint, n of them
    independent_fraction: float  # share of the rows that carries independent noise
    load: FloatArray  # largest rigid-body torque of each joint [N·m], (n,)

    def indices(self, joint: int, columns: Sequence[Column]) -> NDArray[np.intp]:
        """Indices of friction columns of a joint."""
        return np.array([self.places[joint][column] for column in columns], dtype=np.intp)


def base_model(leg: Leg, beside: Sequence[Term] = ()) -> TorqueModel:
    """Torque model of rigid bodies, armatures and other given terms, which all candidates share."""
    return TorqueModel(leg, (Armature(), *beside))


def form_design(
    model: TorqueModel,
    recordings: Sequence[Recording],
    preparations: Sequence[Preparation],
    library: Sequence[Sequence[Column]],
    rigid: FloatArray | None = None,
    keep: Keep | None = None,
    *,
    whole: bool = False,
) -> Design:
    """Form the rows, in one pass over the samples."""
    # No row is left out at reversals, unlike the default of a fit: only there does presliding differ from sharp
    # friction.
    prepared = [prepare(model, each, how) for each, how in zip(recordings, preparations, strict=True)]
    step = max(1, -(-sum(len(each.rows) for each in prepared) // ROWS))
    prepared = [each._replace(rows=each.rows[(len(each.rows) - 1) % step // 2 :: step]) for each in prepared]
    parts: list[_Part] = []
    for index, each in enumerate(prepared):
        states = _states(each.motion, library)  # type: ignore[arg-type]  # TorqueModel makes Motion
        parts += [
            _form(model, each, stretch, library, states, rigid, index, whole=whole) for stretch in each.stretches()
        ]
    fraction = min(1.0, float(np.mean([each.independent_fraction for each in prepared])) * step)
    masks = [p.counted & (True if keep is None else np.asarray(keep(p.recording, p.time))) for p in parts]
    pairs = list(zip(parts, masks, strict=True))
    return Design(
        np.concatenate([np.full(int(mask.sum()), p.recording, dtype=np.intp) for p, mask in pairs]),
        np.concatenate([p.time[mask] for p, mask in pairs]),
        np.vstack([p.v[mask] for p, mask in pairs]),
        np.hstack([p.tau[:, mask] for p, mask in pairs]),
        np.concatenate([p.base[:, mask] for p, mask in pairs], axis=1),
        tuple(np.vstack([p.friction[joint][mask] for p, mask in pairs]) for joint in range(len(library))),
        tuple({column: k for k, column in enumerate(of_joint)} for of_joint in library),
        fraction,
        np.max([p.load for p in parts], axis=0),
    )


class _Part(NamedTuple):
    """Rows of a stretch."""

    recording: int
    counted: NDArray[np.bool_]
    time: FloatArray
    v: FloatArray
    tau: FloatArray
    base: FloatArray
    friction: list[FloatArray]
    load: FloatArray


_States = dict[tuple[int, InternalState], FloatArray]


def _states(motion: Motion, library: Sequence[Sequence[Column]]) -> _States:
    """Internal states of all friction columns, over the whole recording."""
    needed = {(j, column.term.internal_state) for j, of_joint in enumerate(library) for column in of_joint}
    return {(j, state): state.states(motion.q[:, j], motion.v[:, j]) for j, state in needed if state is not None}


def _form(
    model: TorqueModel,
    prepared: Prepared,
    stretch: range,
    library: Sequence[Sequence[Column]],
    states: _States,
    rigid: FloatArray | None,
    index: int,
    *,
    whole: bool,
) -> _Part:
    """Form a stretch of rows, joint by joint."""
    around = slice(max(0, stretch[0] - prepared.reach), stretch[-1] + 1 + prepared.reach)
    inside = range(stretch[0] - around.start, stretch[-1] + 1 - around.start, stretch.step)
    motion: Motion = prepared.motion.rows(around)
    columns = model.columns(motion)
    load = np.zeros(columns.shape[1:]) if rigid is None else np.tensordot(rigid, columns[: len(rigid)], axes=1)
    if rigid is not None and motion.payload is not None:
        load += motion.payload.T
    count, joints = len(columns), columns.shape[1]
    gain = _gain(prepared, around, inside) if whole else 1.0
    base, friction, tau = np.zeros((joints, len(inside), count)), [], np.zeros((joints, len(inside)))
    for joint, of_joint in enumerate(library):
        acting = np.flatnonzero(model.acting[joint])
        extra = np.zeros((len(of_joint), columns.shape[2]))
        _fill(motion, joint, load[joint], of_joint, {key: state[around] for key, state in states.items()}, extra)
        signals = np.vstack([columns[acting, joint], extra, prepared.tau[around, joint]])
        if prepared.parallel is None:
            filtered = signals[:, inside.start : inside.stop : inside.step]
        else:
            filtered = prepared.parallel.among_zeros(signals, inside, prepared.inside[around]) / gain
        base[joint][:, acting] = filtered[: len(acting)].T
        friction.append(filtered[len(acting) : -1].T)
        tau[joint] = filtered[-1]
    rows = slice(stretch.start, stretch.stop, stretch.step)
    v, counted = prepared.motion.v[rows], prepared.inside[rows]
    return _Part(index, counted, prepared.time[rows], v, tau, base, friction, np.abs(load).max(axis=1))


def _gain(prepared: Prepared, around: slice, inside: range) -> FloatArray:
    """What the filter makes of ones in all segments: rows fade towards their ends."""
    counted = prepared.inside[around]
    if prepared.parallel is None:
        return np.ones(len(inside))
    gain = prepared.parallel.among_zeros(counted[None].astype(np.float64), inside)[0]
    return np.where(counted[inside.start : inside.stop : inside.step], gain, 1.0)


def _fill(
    motion: Motion, joint: int, load: FloatArray, columns: Sequence[Column], states: _States, out: FloatArray
) -> None:
    """Write the friction columns of a joint."""
    for row, column in enumerate(columns):
        term = column.term
        state = term.internal_state
        of_joint = JointMotion(
            motion.q[:, joint],
            motion.v[:, joint],
            motion.a[:, joint],
            load,
            None if state is None else states[joint, state],
        )
        both = np.zeros((len(term.symbols), len(load)))
        term.fill(of_joint, both)
        out[row] = both[term.symbols.index(column.symbol)]
