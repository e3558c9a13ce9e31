"""Friction models chosen joint by joint, with the rigid bodies shared."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.identification.gather import model_with
from exoid.leg.leg import Leg
from exoid.signals import Recording, without_torque_delay
from exoid.torques import Armature, Term
from exoid.torques.terms import REVERSAL

from .design import Design, form_design
from .held_out import Fold, blocked_folds, fast_blocks, fold_of, rms
from .normal_equations import NormalEquations, residuals
from .patterns import ALWAYS, LOAD, PLAIN, VELOCITIES, Columns, Grid, Pattern, patterns


@dataclass(frozen=True)
class Search:
    """What is searched for friction models, joint by joint."""

    leg: Leg  # the leg
    recordings: Sequence[Recording]  # the recordings
    cutoff: float  # cut-off frequency of the parallel filter [Hz]
    folds: int  # number of folds in time
    progress: Callable[[float], object] = lambda _: None  # called with the share done
    beside: tuple[Term, ...] = ()  # terms that every model has besides rigid bodies, armatures and friction
    late: Mapping[int, float] = field(default_factory=dict)  # delay of the torque of each joint [s], by its index
    known: Mapping[str, float] = field(default_factory=dict)  # values of parameters that every model holds

    def design(self, library: Sequence[Columns], rigid: FloatArray | None) -> Design:
        """Form the rows of a fit."""
        model = model_with(self.leg, (Armature(), *self.beside), self.known)  # what all candidates share
        recordings = [without_torque_delay(model.select(one), self.late) for one in self.recordings if self.late]
        design = form_design(model, recordings or self.recordings, self.cutoff, library, rigid)
        return design._replace(known={model.names.index(name): value for name, value in self.known.items()})


class Choice(NamedTuple):
    """Friction columns of each joint, and the fit with them."""

    columns: tuple[Columns, ...]  # friction columns of each joint, n of them
    base: FloatArray  # parameters of rigid bodies and armatures, (p,)
    friction: list[FloatArray]  # coefficients of each joint, n of them
    left: FloatArray  # residuals [N·m], (n, N)
    sigma: FloatArray  # standard deviation of each joint's residual [N·m], (n,)

    @classmethod
    def of(cls, design: Design, columns: tuple[Columns, ...], sigma: FloatArray) -> Choice:
        """Fit these columns."""
        whole = NormalEquations.of(design, np.ones(len(design.time)) / sigma[:, None] ** 2)
        active = [design.indices(joint, of_joint) for joint, of_joint in enumerate(columns)]
        base, friction = whole.solve(active)
        left = residuals(design, active, base, friction)
        floor = 1e-9 * np.sqrt(np.mean(design.tau**2))
        return cls(columns, base, friction, left, np.maximum(rms(left, design.moves), floor))


class Tables(NamedTuple):
    """Columns of all settings under the load of some rigid bodies, and normal equations of all folds."""

    design: Design  # the rows
    grids: tuple[Grid, ...]  # settings that are tried at each joint, n of them
    folds: tuple[Fold, ...]  # folds in time, then that of the fastest seconds
    equations: tuple[NormalEquations, ...]  # normal equations of each fold
    whole: NormalEquations  # those of all rows

    @classmethod
    def of(cls, search: Search, grids: tuple[Grid, ...], choice: Choice) -> Tables:
        """Form them."""
        pairs = zip(grids, choice.columns, strict=True)
        library = [tuple(dict.fromkeys((*grid.columns, *chosen))) for grid, chosen in pairs]
        design = search.design(library, choice.base[: len(search.leg.parameter_names)])
        blocks = (*blocked_folds(search.recordings, search.folds), fast_blocks(search.recordings))
        folds = tuple(fold_of(each, design) for each in blocks)
        precision = 1.0 / choice.sigma[:, None] ** 2  # of the joints' noise
        equations = tuple(NormalEquations.of(design, fold.fitted * precision) for fold in folds)
        whole = NormalEquations.of(design, np.ones(len(design.time)) * precision)
        return cls(design, grids, folds, equations, whole)


class Found(NamedTuple):
    """End of a search."""

    search: Search  # what was searched
    tables: Tables  # tables of the last sweep
    choice: Choice  # friction of each joint
    banned: tuple[frozenset[str], ...]  # symbols that each joint must not have, n of them

    def without(self, joint: int, symbol: str) -> Found:
        """Choose again for a joint, without a coefficient."""
        banned = list(self.banned)
        banned[joint] |= {symbol}
        columns = list(self.choice.columns)
        columns[joint] = choose(self.tables, joint, self.choice.columns, self.choice.sigma, banned[joint])
        choice = Choice.of(self.tables.design, tuple(columns), self.choice.sigma)
        return self._replace(choice=choice, banned=tuple(banned))


def search_joint_by_joint(search: Search) -> Found:
    """Sweep over the joints until predictions settle, at most four times after two in which all have an offset."""
    # What an offset is worth shows when the load of friction is right: without these sweeps, seed 0 of the proving
    # ground ends in three times the error.
    plain = (PLAIN,) * len(search.leg.joint_names)
    start = search.design(plain, None)
    choice = Choice.of(start, plain, Choice.of(start, plain, np.ones(len(plain))).sigma)
    before: FloatArray | None = None
    joints, offset_sweeps = len(plain), 2
    sweeps = offset_sweeps + 4
    for sweep in range(sweeps):
        grids = tuple(Grid().about(columns, sweep) if sweep else Grid() for columns in choice.columns)
        tables, chosen = Tables.of(search, grids, choice), list(choice.columns)
        for joint in range(joints):
            chosen[joint] = choose(tables, joint, chosen, choice.sigma, with_offset=sweep < offset_sweeps)
            search.progress((sweep * joints + joint + 1) / (sweeps * joints))
        choice = Choice.of(tables.design, tuple(chosen), choice.sigma)
        explained = tables.design.tau - choice.left
        if before is not None and sweep > offset_sweeps:
            moved = np.sqrt(np.mean((explained - before) ** 2, axis=1)) / choice.sigma
            if moved.max() <= 0.05:  # part of the residual by which a joint's predicted torque still changes
                break
        before = explained
    return Found(search, tables, choice, (frozenset(),) * joints)


def choose(
    tables: Tables,
    joint: int,
    chosen: Sequence[Columns],
    sigma: FloatArray,
    banned: frozenset[str] = frozenset(),
    *,
    with_offset: bool = False,
) -> Columns:
    """Choose the friction of one joint: fewest numbers within one standard error of the least error."""
    design = tables.design
    active = [design.indices(k, columns) for k, columns in enumerate(chosen)]
    whole = tables.whole.project(joint, active)
    projected = [each.project(joint, active) for each in tables.equations]
    rows = [design.some(fold.tested) for fold in tables.folds]
    held_out = [each.residuals(of_fold, joint, active) for each, of_fold in zip(projected, rows, strict=True)]
    # weight of a tested row of each fold: the mean error in time and that of the fastest seconds are added
    tested = [max(int(fold.tested.sum()), 1) for fold in tables.folds]
    weights = [*np.full(len(tested) - 1, 1.0 / sum(tested[:-1])), 1.0 / tested[-1]]
    candidates: list[tuple[Pattern, Columns, FloatArray]] = []
    gains: dict[Pattern, float] = {}
    # The torque of a passive joint is 0 = load + friction: mu = 1, with no other parameter, explains all of it.
    banned |= frozenset(() if design.tau[joint].any() else LOAD)
    for pattern in patterns():
        if banned & set(pattern.symbols) or (with_offset and "offset" not in pattern.symbols):
            continue
        settings = tables.grids[joint].settings(pattern)
        sets = np.array([design.indices(joint, columns) for columns in settings])
        c, variance, explained = whole.solve(sets)
        always = np.array([symbol in (*ALWAYS, "offset") for symbol in pattern.symbols], dtype=np.bool_)
        # determined to 30 %, but for c0, d and offset, which nearly every joint has
        sure = (variance <= (0.3 * c) ** 2 * design.independent_fraction) | always
        good = pattern.dissipative(c) & sure.all(axis=1)
        best = int(np.argmax(np.where(good, explained, -np.inf)))
        # Stribeck friction that is so slow describes smoothing, or reversals that the fit leaves out
        slow = ((one.velocity, VELOCITIES[0] if one.length else 1.3 * REVERSAL) for one in settings[best])
        if not good.any() or any(0.0 < velocity <= least for velocity, least in slow):
            continue
        gain = float(explained[best])
        if any(other >= gain for simpler, other in gains.items() if simpler.within(pattern)):
            continue  # a bound would be active: the best positive coefficients are those of the simpler model
        gains[pattern] = gain
        loss = np.zeros(len(design.time))
        for fold, equations, weight, (left, G) in zip(tables.folds, projected, weights, held_out, strict=True):
            c, _, lower = equations.solve(sets)
            good = pattern.dissipative(c)
            index = int(np.argmax(np.where(good, lower, -np.inf))) if good.any() else best
            error = (left - np.tensordot(c[index], G[sets[index]], 1)) / sigma[:, None]
            loss[fold.tested] += weight * np.sum(error**2, axis=0)
        candidates.append((pattern, settings[best], loss))
    # A pattern without c0 or d is there for joints at which it would be negative.
    return _fewest([one for one in candidates if not any(one[0].lacks(other[0]) for other in candidates)])


def _fewest(candidates: Sequence[tuple[Pattern, Columns, FloatArray]]) -> Columns:
    """Columns with the fewest numbers that predict as well as the best, by the share of each row in the error."""
    # As well: within one standard error, or two if the error grows by less than 5 %. In nearly exact rows, a setting
    # that the grid lacks looks like small Stribeck friction. Beyond 5 %, two drop friction that is there.
    errors = [float(loss.sum()) for _, _, loss in candidates]
    best = int(np.argmin(errors))
    for k in sorted(range(len(candidates)), key=lambda k: (candidates[k][0].complexity, errors[k])):
        # Residuals are correlated: the standard error of the difference comes from sums over 20 blocks of rows.
        difference = candidates[k][2] - candidates[best][2]
        sums = [float(block.sum()) for block in np.array_split(difference, min(20, len(difference)))]
        standard_error = float(np.sqrt(len(sums)) * np.std(sums, ddof=1)) if len(sums) > 1 else 0.0
        if errors[k] - errors[best] <= min(2.0 * standard_error, max(standard_error, 0.05 * errors[best])):
            return candidates[k][1]
    return candidates[best][1]
