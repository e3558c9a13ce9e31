"""Numbers that change while data are recorded: a zero, a scale, an offset, a load, from some time on or in one log.

One value of each parameter is fitted to all data. A number that changes on the way leaves residuals that its column,
set to zero before the change, explains: a test of constant parameters (Andrews 1993) with the columns of the faults.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.regression.least_squares import TINY
from exoid.torques import Offset, TorqueModel

from .columns import Column
from .evidence import Evidence
from .kinds import Nuisance
from .score import LARGE_GAIN, State

BLOCKS = 60
"""Blocks of all data."""


class Change(NamedTuple):
    """Another value of one number in consecutive rows."""

    rows: tuple[slice, ...]  # where it has the other value, in each part of the data
    when: str  # the same in words
    within: bool  # whether this begins in the midst of a recording
    column: int = -1  # its column among those of parameters and faults
    sign: float = 1.0  # of the column


def with_change(evidence: Evidence, change: Change) -> Evidence:
    """Add the column of a change behind the others."""

    def added(table: FloatArray, rows: slice) -> FloatArray:
        changed = np.zeros(table.shape[1])
        changed[rows] = change.sign * table[change.column, rows]
        return np.insert(table, -1, changed, axis=0)

    tables = [[added(*one) for one in zip(of_joint, change.rows, strict=True)] for of_joint in evidence.tables]
    return evidence.of_tables(tables)


def described(change: Change, evidence: Evidence, model: TorqueModel, columns: Sequence[Column]) -> Nuisance:
    """Name a change, whose column is the last."""
    count, last = len(evidence.fixed), evidence.factors[0].shape[1] - 2 - len(evidence.fixed)
    if change.column < count:
        joint = int(np.flatnonzero(model.acting[:, change.column])[-1])
        unit, what = model.units[change.column], model.names[change.column]
    else:
        kind, joint, _ = columns[change.column - count]
        if kind == "gains":
            return Nuisance("change", "", -1, "1", (last,), f"{change.when}, the scale of all torques")
        unit, what = ("1", "the scale of the torque") if kind == "gain" else ("rad", "the offset of the angle")
        what = f"{what} of {model.leg.joint_names[joint]}"
    return Nuisance("change", model.leg.joint_names[joint], joint, unit, (last,), f"{change.when}, {what}")


def find_change(state: State, model: TorqueModel, nuisances: Sequence[Column]) -> Change | None:
    """Find the change of one number that is the least likely in noise, if it explains much."""
    # Inertia changes with mass moments, which show better. Friction is compared, too: it is another one in the next
    # recording, but what changes in the midst of one is the form of friction, which hardly moves other parameters.
    count = len(model.names)
    free = [k for k in state.evidence.free.tolist() if model.units[k] != "kg·m²"]
    zeros = [count + k for k, one in enumerate(nuisances) if one.kind == "zero"]
    gains = [count + k for k, one in enumerate(nuisances) if one.kind in ("gain", "gains")]
    carries = any(one.kind == "known" for one in nuisances)  # payloads, or measured wrenches
    offsets = {name for block in model.blocks if isinstance(block.term, Offset) for name in block.names}
    moments = {k for k in free if k < len(model.leg.parameter_names)}
    friction = {k for k in free if k not in moments and model.names[k] not in offsets}
    found = [*_changes(state, [*free, *zeros, *gains], gains if carries else ())]
    if not found:
        return None
    _, gain, best = max(found, key=lambda one: one[0])
    if best.column in moments:  # a sensor that explains as much is likelier: its zero turns the mass moment
        as_much = [one for one in found if one[2].column not in moments | friction and one[1] > gain - LARGE_GAIN]
        best = max(as_much, key=lambda one: one[0])[2] if as_much else best
    if best.within and best.column in friction:
        return None
    return best._replace(sign=-1.0) if best.column in zeros else best  # what an angle reads too much


def _changes(state: State, columns: Sequence[int], scales: Sequence[int]) -> Iterator[tuple[float, float, Change]]:
    """Test all changes, each beside the fitted columns: score² / variance, share that it explains, where it is much."""
    # Other friction explains less than a tenth of the squared residuals. What carries the scale of all, such as a
    # payload, is in few logs: there a small change moves all parameters far.
    chosen = list(dict.fromkeys((*state.columns.tolist(), *columns)))
    own = [chosen.index(k) for k in columns]
    blocks, grams = _grams(state, [*chosen, -1])
    fitted = len(state.columns)
    residual = grams[:, :, -1] - grams[:, :, :fitted] @ state.solution  # Xᵀr and Zᵀr of each block
    inverse, rss = state.pinv @ state.pinv.T, float(state.residual @ state.residual)
    each = grams[:, :fitted, own], np.diagonal(grams, axis1=1, axis2=2)[:, own], residual[:, own]
    # Xᵀz, zᵀz and zᵀr of all blocks before each
    sums = [np.cumsum(np.insert(x, 0, 0.0, axis=0), axis=0) for x in each]
    for place, first, last in _places(state.evidence, blocks):
        inside = np.zeros(len(blocks))
        inside[first:last] = 1.0
        crossed, size, score = (total[last] - total[first] for total in sums)
        # z is the column of a number inside, and zero outside; X a is what the fitted columns explain of it
        share = inverse @ crossed
        information = size - np.sum(share * crossed, axis=0)
        least = np.where(np.isin(columns, scales) & (not place.within), 0.0, 0.1)
        much = (information > 0.01 * size) & (score**2 > least * rss * np.maximum(information, TINY))
        for k in np.flatnonzero(much).tolist():
            # variance of the score by those of the blocks, less the change
            a, z = share[:, k], inside[:, None] * grams[:, :, own[k]]
            across = z[:, :fitted] - grams[:, :fitted, :fitted] @ a
            power = z[:, own[k]] - z[:, :fitted] @ a - across @ a
            of_blocks = inside * residual[:, own[k]] - residual[:, :fitted] @ a - power * score[k] / information[k]
            statistic = score[k] ** 2 / max(of_blocks @ of_blocks, TINY)
            yield float(statistic), float(score[k] ** 2 / (information[k] * rss)), place._replace(column=columns[k])


def _grams(state: State, columns: Sequence[int]) -> tuple[list[tuple[int, int]], FloatArray]:
    """Begin of each block, part and row, and products of some of its columns."""
    evidence = state.evidence
    size = max(8, -(-sum(len(part.time) for part in evidence.parts) // BLOCKS))
    blocks, grams = [], []
    for place, (part, rest) in enumerate(zip(evidence.parts, evidence.at_rest, strict=True)):
        starts = np.linspace(0, len(part.time), 1 if rest else max(1, round(len(part.time) / size)), endpoint=False)
        several = [w * of_joint[place][columns] for w, of_joint in zip(state.weights, evidence.tables, strict=True)]
        for start, stop in pairwise([*starts.astype(np.intp).tolist(), len(part.time)]):
            blocks.append((place, start))
            rows = np.hstack([table[:, start:stop] for table in several])
            grams.append(rows @ rows.T)
    return blocks, np.array(grams)


def _places(evidence: Evidence, blocks: Sequence[tuple[int, int]]) -> Iterator[tuple[Change, int, int]]:
    """Where a number may have another value, first and last block: from a time on, or in one recording alone."""
    both = pairwise(zip(evidence.sources, evidence.parts, strict=True))
    # another recording is another file, or times that begin anew
    begins = [True, *(name != other or after.time[0] < one.time[-1] for (name, one), (other, after) in both)]
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
