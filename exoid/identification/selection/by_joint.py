"""Ways to identify a leg: the friction model of each joint, and the fit that confirms."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import NotIdentifiableError
from exoid.estimate.estimate import Estimate
from exoid.identification.identify import FitOptions, identify
from exoid.leg.leg import Leg
from exoid.signals import Recording, ZeroPhase
from exoid.torques import Armature, Term
from exoid.torques.catalog import radians

from .held_out import held_out_errors
from .patterns import ALWAYS, PLAIN, Columns, absent, terms_of
from .per_joint import Choice, Found, Search, search_joint_by_joint

ALIKE = 1.03  # ratio of errors up to which models predict alike, by seeds below 100 of the proving ground


@dataclass(frozen=True, eq=False)
class Candidate:
    """One way to identify a leg, and how it did."""

    name: str  # short name for tables
    terms: tuple[Term, ...]  # terms of the torque model
    known: Mapping[str, float]  # parameters that are held: those that are known, and at zero coefficients left out
    delay: str | None  # "auto" to take delays out of the torques
    numbers: int  # number of parameters that it fits, and of settings that were chosen
    failure: str  # why it could not be fitted; empty if it could
    nrmse: FloatArray  # NRMSE of each joint over all folds, (n,)
    folds: FloatArray  # NRMSE averaged over the joints, of each fold, relative to the torque of the whole, (K,)
    extrapolation: FloatArray  # of the fastest seconds predicted from the others, (n,); not a number if these are few

    @property
    def fast(self) -> float:
        """Mean of the extrapolation over the joints; not a number where there is none."""
        known = self.extrapolation[np.isfinite(self.extrapolation)]
        return float(known.mean()) if len(known) else np.nan

    @property
    def mean(self) -> float:
        """Mean NRMSE over joints and folds in time."""
        return np.inf if self.failure else float(self.folds.mean())

    @property
    def error(self) -> float:
        """Mean and fast error, added: as at each joint, stretches of time and faster motion count alike."""
        return float(self.mean + np.nan_to_num(self.fast))

    def fit(self, leg: Leg, recordings: Recording | Sequence[Recording], cutoff: float) -> Estimate:
        """Identify with what is known."""
        how: FitOptions = {"preparation": ZeroPhase(cutoff), "known": self.known, "delay": self.delay}
        return identify(leg, recordings, self.terms, "huber", **how)

    def to_json(self) -> dict[str, Any]:
        """Turn the figures into what JSON can hold."""
        arrays = {"nrmse": self.nrmse, "folds": self.folds, "fast": self.extrapolation}
        figures = {name: [x if np.isfinite(x) else None for x in array.tolist()] for name, array in arrays.items()}
        return {"name": self.name, "numbers": self.numbers, **figures, "failure": self.failure}


def select_by_joint(search: Search) -> tuple[list[Candidate], int, tuple[Columns, ...], Estimate]:
    """Choose the friction of each joint: all candidates, which, its friction, and its fit."""
    ends = _ends(search)
    plain = ends[0][1]
    plain = plain._replace(choice=plain.choice._replace(columns=(PLAIN,) * len(search.leg.joint_names)))
    coulomb = _scored(plain.search, "coulomb", plain.choice)
    ends = [*(_no_worse(*one, coulomb.nrmse) for one in ends), (coulomb, plain)]
    search.progress(0.75)
    while True:
        chosen = min(range(len(ends)), key=lambda k: ends[k][0].error * (ALIKE if k else 1.0))
        candidate, found = ends[chosen]
        if candidate.failure:
            what = f"no candidate can be fitted: {candidate.failure}"
            raise NotIdentifiableError(what, remedy="record longer and richer motions")
        estimate = candidate.fit(search.leg, search.recordings, search.cutoff)
        faults = _faults(found, estimate)
        if not faults:
            break
        for joint, symbol in faults:  # each round bans a coefficient for good; another candidate may then be better
            found = found.without(joint, symbol)
        ends[chosen] = _scored(found.search, candidate.name, found.choice), found
    search.progress(1.0)
    return [one for one, _ in ends], chosen, found.choice.columns, estimate


def _ends(search: Search) -> list[tuple[Candidate, Found]]:
    """Ends of the search joint by joint, the one to take first."""

    def end(name: str, mine: Search, begin: float) -> tuple[Candidate, Found]:
        found = search_joint_by_joint(replace(mine, progress=lambda share: search.progress(begin + 0.25 * share)))
        return _scored(mine, name, found.choice), found

    # Friction of another form may look like a delay: torques that seem late are also taken as they are.
    ends = [end("by joint", replace(search, late={}), 0.0)]
    if search.late:
        ends = [min(*ends, end("by joint", search, 0.25), key=lambda one: one[0].error)]
    sizes = dict(zip(search.leg.parameter_names, search.leg.parameters.tolist(), strict=True))
    # a Y that is rounding says that the segment is symmetric
    wide = {name: 1e-4 * abs(sizes.get(f"X{name[1:]}", 0.0)) for name in sizes if name.startswith("Y")}
    symmetric = {name: sizes[name] for name, bound in wide.items() if abs(sizes[name]) < bound}
    if symmetric.keys() - search.known.keys():
        knowing = replace(ends[0][1].search, known={**symmetric, **search.known})
        ends.append(end(f"by joint, {' '.join(symmetric)} of the URDF", knowing, 0.5))
        if ends[1][0].error <= ALIKE * ends[0][0].error:  # what the URDF says counts unless the rows speak against it
            ends.reverse()
    return ends


def _scored(search: Search, name: str, choice: Choice) -> Candidate:
    """Candidate with these friction models, and its errors on rows that are held out."""
    leg, friction, known = search.leg, list[Term](), dict[str, float]()
    each = zip(choice.columns, leg.joint_names, leg.joint_labels, radians(leg).tolist(), strict=True)
    for columns, joint, label, radian in each:
        every, chosen = (*columns, *absent(columns)), {column.symbol for column in columns}
        friction += terms_of(every, joint, radian)
        symbols = (symbol for column in every for symbol in column.term.symbols)
        known |= {f"{symbol}_{label}": 0.0 for symbol in symbols if symbol not in chosen}  # what the choice leaves out
    terms, delay = (*friction, Armature(), *search.beside), "auto" if search.late else None
    known |= search.known
    design = search.design(choice.columns, choice.base[: len(leg.parameter_names)])  # joints are loaded by its bodies
    nrmse, of_folds, fast = held_out_errors(design, search.recordings, search.folds)
    failure = "" if np.isfinite(of_folds).all() else "rows are too few for all folds"
    settings = [{(key, getattr(c, key)) for c in one for key in ("length", "velocity")} for one in choice.columns]
    numbers = len(choice.base) + sum(map(len, choice.columns)) + sum(bool(x) for one in settings for _, x in one)
    return Candidate(name, terms, known, delay, numbers - len(search.known), failure, nrmse, of_folds, fast)


def _faults(found: Found, estimate: Estimate) -> list[tuple[int, str]]:
    """Joint and symbol of each friction coefficient that drives, or that the recordings do not determine."""
    at_fault = []  # of one joint the least determined: without it, the others may be good
    figures = zip(estimate.values, estimate.std, estimate.identifiability, strict=True)
    numbers = dict(zip(estimate.names, figures, strict=True))
    for joint, (columns, label) in enumerate(zip(found.choice.columns, found.search.leg.joint_labels, strict=True)):
        faults: list[tuple[float, str]] = []
        for column in columns:
            value, std, judged = numbers[f"{column.symbol}_{label}"]
            rest = numbers[f"c0_{label}"][0] if column.symbol == "cs" else 0.0  # c0 + cs is to dissipate
            drives = value + rest <= 0.0 and column.symbol != "offset"
            if drives or (judged == "not" and column.symbol not in ALWAYS):
                faults.append((float((value if drives else abs(value)) / max(std, 1e-300)), column.symbol))
        if faults:
            at_fault.append((joint, min(faults)[1]))
    return at_fault


def _no_worse(candidate: Candidate, found: Found, coulomb: FloatArray) -> tuple[Candidate, Found]:
    """Take Coulomb and viscous friction at joints that these predict better, where all errors together fall."""
    for joint in np.flatnonzero(candidate.nrmse > coulomb):
        columns = tuple(PLAIN if j == joint else own for j, own in enumerate(found.choice.columns))
        choice = found.choice._replace(columns=columns)
        other = _scored(found.search, candidate.name, choice)
        if other.error < candidate.error:
            candidate, found = other, found._replace(choice=choice)
    return candidate, found
