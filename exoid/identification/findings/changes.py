"""Numbers that change while data are recorded: a zero, a scale, an offset, a load, from some time on or in one log.

One value of each parameter is fitted to all data. A number that changes on the way leaves residuals that its column,
set to zero before the change, explains: a test of constant parameters (Andrews 1993) with the columns of the faults.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.leg.leg import Leg
from exoid.regression.least_squares import TINY, scaled_inverse
from exoid.torques import Offset, TorqueModel
from exoid.torques.catalog import turning_joints

from .columns import Column
from .evidence import Evidence
from .kinds import Nuisance
from .sample import log_starts
from .score import State

BLOCKS = 60  # of all data


class Change(NamedTuple):
    """Other values of m numbers in consecutive rows."""

    rows: tuple[slice, ...]  # where they have other values, in each part of the data
    when: str  # the same in words
    within: bool  # whether this begins in the midst of a recording
    columns: tuple[int, ...] = ()  # columns among those of parameters and faults, C of them
    mix: tuple[tuple[float, ...], ...] = ()  # how these add up to the column of each number, m of (C,)
    joint: int = -1  # index of the joint that carries the load that changes; −1 for another number


def with_change(evidence: Evidence, change: Change) -> Evidence:
    """Add the columns of a change behind the others."""

    def added(table: FloatArray, rows: slice) -> FloatArray:
        changed = np.zeros((len(change.mix), table.shape[1]))
        changed[:, rows] = np.array(change.mix) @ table[list(change.columns), rows]
        return np.insert(table, -1, changed, axis=0)

    tables = [[added(*one) for one in zip(of_joint, change.rows, strict=True)] for of_joint in evidence.tables]
    return evidence.of_tables(tables)


def described(change: Change, evidence: Evidence, model: TorqueModel, columns: Sequence[Column]) -> Nuisance:
    """Name a change, whose columns are the last."""
    count, names, last = len(evidence.fixed), model.leg.joint_names, evidence.factors[0].shape[1] - 1
    own = tuple(range(last - count - len(change.mix), last - count))
    if change.joint >= 0:
        return Nuisance("wrong-load", names[change.joint], change.joint, "kg·m", own, change.when)
    (column,), joint = change.columns, _joint(change.columns[0], model, columns)
    if column < count:
        unit, what = model.units[column], model.names[column]
    else:
        kind = columns[column - count].kind
        angle = "rad" if turning_joints(model.leg)[joint] else "m"
        unit, what = {"gain": ("1", "scale"), "delay": ("s", "delay")}.get(kind.removesuffix("s"), (angle, "offset"))
        if joint < 0:
            return Nuisance("change", "", -1, unit, own, f"{change.when}, the {what} of all torques")
        what = f"the {what} of the {'angle' if kind == 'zero' else 'torque'} of {names[joint]}"
    return Nuisance("change", names[joint], joint, unit, own, f"{change.when}, {what}")


def find_changes(state: State, model: TorqueModel, nuisances: Sequence[Column]) -> Iterator[Change]:
    """Find the change of one number, and that of a load, that explain most beside the fitted columns, if it is much."""
    # Mass moments change with a load. Friction is compared, too: it is another one in the next recording, but what
    # changes in the midst of one is the form of friction, which hardly moves other parameters. It explains less than a
    # tenth of the squared residuals of two joints, and hides no change of another joint.
    count, rigid, fitted = len(model.names), len(model.leg.parameter_names), len(state.columns)
    free = [k for k in state.evidence.free.tolist() if k >= rigid and model.units[k] != "kg·m²"]
    zeros = [count + k for k, one in enumerate(nuisances) if one.kind == "zero"]
    gains = [count + k for k, one in enumerate(nuisances) if one.kind in ("gain", "gains")]
    # what carries the scale of all, a payload or a measured wrench, is in few logs: there a small one moves all far
    carries = any(one.kind == "known" for one in nuisances)
    offsets = {name for block in model.blocks if isinstance(block.term, Offset) for name in block.names}
    late = [count + k for k, one in enumerate(nuisances) if one.kind in ("delay", "delays")]
    tested, loads = np.array([*free, *zeros, *gains, *late], dtype=np.intp), _loads(model.leg)
    blocks, products = _products(state, tested, loads.reshape(-1, rigid))
    places = list(_places(state.evidence, blocks))
    # z is the column of a number inside a place, and zero outside; of ZᵀZ the fitted columns explain a share
    within = [[float(first <= k < last) for k in range(len(blocks))] for _, first, last in places]
    inside = np.tensordot(np.reshape(within, (-1, len(blocks))), products, axes=1)
    cross, whole, score = inside[:, :fitted, :-1], inside[:, fitted:-1, :-1], inside[:, fitted:-1, -1]
    information = whole - cross.transpose(0, 2, 1) @ (state.pinv @ state.pinv.T @ cross)
    rss, best = max(float(state.residual @ state.residual), TINY), list[Change]()
    sizes, left = (np.diagonal(x, axis1=1, axis2=2)[:, : len(tested)] for x in (whole, information))
    gain = score[:, : len(tested)] ** 2 / np.maximum(left, TINY) / rss
    midst = np.array([place.within for place, *_ in places], dtype=np.bool_)[:, None]
    least = np.where(np.isin(tested, gains) & carries & ~midst, 0.0, 0.1 * state.evidence.share_of_two)
    least[midst & np.isin(tested, late)] = np.inf  # of another clock there are other columns
    gain = np.where((left > 0.01 * sizes) & (gain > least), gain, 0.0)
    forms = midst & np.isin(tested, [k for k in free if model.names[k] not in offsets])
    joints = np.array([_joint(k, model, nuisances) for k in tested.tolist()])
    alike = (joints[:, None] == joints) | (joints[:, None] < 0)
    of_forms = np.max(gain * forms, axis=0, initial=0.0)
    gain = np.where(forms | (gain <= np.max(alike * of_forms, axis=1)), 0.0, gain)
    if gain.any():
        place, k = np.unravel_index(gain.argmax(), gain.shape)
        best.append(places[place][0]._replace(columns=(int(tested[k]),), mix=((1.0,),)))
    of_load = len(tested) + np.arange(loads.shape[0] * loads.shape[1]).reshape(loads.shape[:2])
    own = np.s_[:, of_load[:, :, None], of_load[:, None]]
    sizes, score = whole[own] * np.eye(loads.shape[1]), score[:, of_load]
    size = (scaled_inverse(information[own] + 0.01 * sizes) @ score[..., None])[..., 0]
    explained, count_of = (score * size).sum(axis=-1) / rss, np.count_nonzero(sizes, axis=(-2, -1))
    # a load within 2 m of its joint has no larger inertia [kg·m²] beside its mass moment [kg·m]
    possible = (explained > 0.1) & (np.abs(size[..., 4]) < 2.0 * np.linalg.norm(size[..., 1:4], axis=-1))
    gain = -0.5 * state.dof * np.log1p(-np.minimum(explained, 1.0 - 1e-12)) - count_of * np.log(state.dof)
    if possible.any():
        place, joint = np.unravel_index(np.where(possible, gain, -np.inf).argmax(), gain.shape)
        mix = tuple(map(tuple, loads[joint].tolist()))
        best.append(places[place][0]._replace(columns=tuple(range(rigid)), mix=mix, joint=int(joint)))
    for one in best:
        yield one._replace(mix=((-1.0,),)) if one.columns[0] in zeros else one  # what an angle reads too much


def _joint(column: int, model: TorqueModel, nuisances: Sequence[Column]) -> int:
    """Index of the joint whose number a column is, the last that it acts on; −1 for all."""
    if column < len(model.names):
        return int(np.flatnonzero(model.acting[:, column])[-1])
    kind, joint, _ = nuisances[column - len(model.names)]
    return -1 if kind in ("gains", "delays") else joint


def _loads(leg: Leg) -> FloatArray:
    """Parameters by the mass of a load on each of n segments, its moments, and inertia about all axes, (n, 5, p)."""
    units = np.zeros((5, 10))
    units[range(4), range(4)] = units[4, [4, 6, 9]] = 1.0
    K = leg.reduction.collect.reshape(-1, len(leg.bodies), 10)  # what is left of an axis turned by π/2 is rounding
    return np.array([units @ K[:, leg.bodies.index(link)].T for link in leg.link_names]).round(9)


def _products(state: State, tested: NDArray[np.intp], loads: FloatArray) -> tuple[list[tuple[int, int]], FloatArray]:
    """Begin of each block, part and row, and [X Z r]ᵀ [Z r] of fitted columns X, tested numbers and loads Z, rest r."""
    evidence, blocks, products = state.evidence, list[tuple[int, int]](), []
    size = max(8, -(-sum(len(part.time) for part in evidence.parts) // BLOCKS))
    for place, (part, rest) in enumerate(zip(evidence.parts, evidence.at_rest, strict=True)):
        several = []
        for weight, tables in zip(state.weights, evidence.tables, strict=True):
            table, X = tables[place], tables[place][state.columns]
            Z = table[tested], loads @ table[: loads.shape[1]]
            several.append(weight * np.vstack([X, *Z, table[-1] - state.solution @ X]))
        starts = np.linspace(0, len(part.time), 1 if rest else max(1, round(len(part.time) / size)), endpoint=False)
        for start, stop in pairwise([*starts.astype(np.intp).tolist(), len(part.time)]):
            blocks.append((place, start))
            pieces = (rows[:, start:stop] for rows in several)
            products.append(sum(piece @ piece[len(state.columns) :].T for piece in pieces))
    return blocks, np.array(products)


def _places(evidence: Evidence, blocks: Sequence[tuple[int, int]]) -> Iterator[tuple[Change, int, int]]:
    """Where a number may have another value, first and last block: from a time on, or in one recording alone."""
    begins = log_starts(evidence.sources, [part.time for part in evidence.parts])
    names = [name or f"recording {number}" for name, number in zip(evidence.sources, np.cumsum(begins), strict=True)]
    several, count, least = sum(begins), len(blocks), max(1, len(blocks) // 20)
    for block in range(least, count - least + 1):
        place, start = blocks[block]
        within = start > 0 or not begins[place]
        when = f"{float(evidence.parts[place].time[start]):.4g} s{f' of {names[place]}' if several > 1 else ''}"
        rows = tuple(slice(start * (k == place), 0 if k < place else None) for k in range(len(begins)))
        yield Change(rows, f"from {when if within else names[place]} on", within), block, count
    edges = np.searchsorted([place for place, _ in blocks], range(len(begins) + 1)).tolist()
    for place, (first, last) in enumerate(pairwise(edges) if several == len(begins) > 2 else ()):
        alone = tuple(slice(0, None if k == place else 0) for k in range(len(begins)))
        yield Change(alone, f"in {names[place]}", within=False), first, last
