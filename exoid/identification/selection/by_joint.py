"""The friction model of each joint, then filter and estimator, then the fit that has to confirm them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate.estimate import Estimate
from exoid.identification.identify import identify
from exoid.leg.leg import Leg
from exoid.signals import Recording, ZeroPhase
from exoid.torques import Armature, Term

from .candidates import Candidate, estimator_candidates, filter_candidates
from .design import base_model
from .fixed_friction import held_out_errors
from .patterns import DRY, PLAIN, absent, describe, terms_of, zeros_of
from .per_joint import Columns, Found, Search, search_joint_by_joint
from .scores import Score, best_of

OFFSET_SWEEPS = 2
"""Sweeps of the second search in which all joints have an offset."""


class JointFriction(NamedTuple):
    """Friction model that was chosen for a joint.

    Attributes:
        joint: Name of the joint.
        coefficients: Symbols of its coefficients, all positive but the offset.
        presliding: Presliding length [rad]; 0 for none.
        smoothing: Velocity over which dry friction changes sign [rad/s]; 0 with presliding and without dry friction.
        stribeck_velocity: Stribeck velocity [rad/s]; 0 for none.
        text: The same in a few words.
    """

    joint: str
    coefficients: tuple[str, ...]
    presliding: float
    smoothing: float
    stribeck_velocity: float
    text: str

    @classmethod
    def of(cls, joint: str, columns: Columns) -> JointFriction:
        """Describe the friction of a joint."""
        length, velocity = (max((getattr(c, name) for c in columns), default=0.0) for name in ("length", "velocity"))
        sharp = [c.smoothing for c in columns if c.symbol in DRY and not length]
        symbols = tuple(column.symbol for column in columns)
        return cls(joint, symbols, length, max(sharp, default=0.0), velocity, describe(columns))

    def to_json(self) -> dict[str, Any]:
        """Turn it into what JSON can hold."""
        return {
            "joint": self.joint,
            "coefficients": list(self.coefficients),
            "presliding": self.presliding,
            "smoothing": self.smoothing,
            "stribeck_velocity": self.stribeck_velocity,
        }


class Chosen(NamedTuple):
    """Choice for all joints."""

    scores: tuple[Score, ...]  # scores of all candidates
    chosen: int  # index of the one that was chosen
    joints: tuple[JointFriction, ...]  # friction model of each joint, n of them
    estimate: Estimate  # the fit that confirmed it


@dataclass(frozen=True)
class _Bench:
    """Where candidates are compared."""

    search: Search
    folds: int
    cutoff: float

    def candidate(self, name: str, chosen: Sequence[Columns], like: Candidate | None = None) -> Candidate:
        """Candidate with these friction models, and the filter and estimator of another."""
        leg = self.search.leg
        friction: list[Term] = []
        zero: list[str] = []
        for columns, joint, label in zip(chosen, leg.joint_names, leg.joint_labels, strict=True):
            friction += terms_of((*columns, *absent(columns)), joint)
            zero += [*zeros_of(columns, label), *(f"{column.symbol}_{label}" for column in absent(columns))]
        like = like or Candidate("", (), preparation=ZeroPhase(self.cutoff))
        return replace(like, name=name, terms=(*friction, Armature(), *self.search.beside), zero=tuple(zero))

    def score(self, candidate: Candidate, chosen: Sequence[Columns], base: FloatArray) -> Score:
        """Predict what is held out, with joints loaded by rigid bodies of these parameters (p,)."""
        search = self.search
        numbers = len(base) + sum(_numbers(columns) for columns in chosen)
        try:
            found = held_out_errors(
                base_model(search.leg, search.beside),
                search.recordings,
                candidate.preparation,
                chosen,
                base[: len(search.leg.parameter_names)],
                folds=self.folds,
                cutoff=self.cutoff,
                robust=candidate.estimator == "huber",
            )
        except ExoidError as error:
            return Score.failed(candidate, len(chosen), self.folds, error.what)
        failure = "" if np.isfinite(found.folds).all() else "rows are too few for all folds"
        return Score(candidate, numbers, found.nrmse, found.folds, found.extrapolation, failure)


def select_by_joint(
    leg: Leg,
    recordings: Sequence[Recording],
    *,
    folds: int,
    cutoff: float,
    tune: bool,
    progress: Callable[[float], None],
    beside: tuple[Term, ...] = (),
) -> Chosen:
    """Choose the friction of each joint, then filter and estimator."""
    bench = _Bench(Search(leg, recordings, ZeroPhase(cutoff), folds, beside=beside), folds, cutoff)
    found = _searched(bench, progress)
    plain: list[Columns] = [PLAIN] * len(leg.joint_names)
    scores = [
        bench.score(bench.candidate(name, columns), columns, found.choice.base)
        for name, columns in (("coulomb", plain), ("by joint", found.choice.columns))
    ]
    progress(0.65)
    chosen = 1
    for more in (filter_candidates, estimator_candidates) if tune else ():
        later = more(scores[chosen].candidate)
        tried = [bench.score(candidate, found.choice.columns, found.choice.base) for candidate in later]
        choice = best_of([scores[chosen], *tried])
        chosen = chosen if choice == 0 else len(scores) + choice - 1
        scores += tried
    progress(0.75)
    estimate = fit_candidate(leg, recordings, scores[chosen].candidate)
    while faults := _faults(found, estimate):  # each round bans a coefficient for good
        for joint, symbol in faults:
            found = found.without(joint, symbol)
        again = bench.candidate(scores[chosen].candidate.name, found.choice.columns, scores[chosen].candidate)
        scores[chosen] = bench.score(again, found.choice.columns, found.choice.base)
        estimate = fit_candidate(leg, recordings, again)
        progress(0.9)
    progress(1.0)
    joints = tuple(JointFriction.of(*pair) for pair in zip(leg.joint_names, found.choice.columns, strict=True))
    return Chosen(tuple(scores), chosen, joints, estimate)


def _searched(bench: _Bench, progress: Callable[[float], None]) -> Found:
    """Search from two starts, as the search may end elsewhere if it starts elsewhere, and take the better end."""
    ends, scores = [], []
    for begin, offset_sweeps in ((0.0, 0), (0.3, OFFSET_SWEEPS)):
        report = partial(_part_done, progress, begin)
        ends.append(search_joint_by_joint(replace(bench.search, offset_sweeps=offset_sweeps, progress=report)))
        choice = ends[-1].choice
        scores.append(bench.score(bench.candidate("by joint", choice.columns), choice.columns, choice.base))
    return ends[best_of(scores)]


def _part_done(progress: Callable[[float], None], begin: float, share: float) -> None:
    progress(begin + 0.3 * share)


def fit_candidate(
    leg: Leg, recordings: Recording | Sequence[Recording], candidate: Candidate, *, nonnegative: bool = False
) -> Estimate:
    """Identify with a candidate; coefficients that it leaves out are held at zero."""
    return identify(
        leg,
        recordings,
        candidate.terms,
        candidate.estimator,
        preparation=candidate.preparation,
        known=dict.fromkeys(candidate.zero, 0.0) or None,
        nonnegative=nonnegative,
    )


def _faults(found: Found, estimate: Estimate) -> list[tuple[int, str]]:
    """Joint and symbol of each friction coefficient that is not positive, or that the recordings do not determine."""
    # Of one joint only the least determined: without it, the others may be good.
    at_fault = []
    figures = zip(estimate.values, estimate.std, estimate.identifiability, strict=True)
    numbers = dict(zip(estimate.names, figures, strict=True))
    for joint, (columns, label) in enumerate(zip(found.choice.columns, found.search.leg.joint_labels, strict=True)):
        faults: list[tuple[float, str]] = []
        for column in columns:
            value, std, judged = numbers[f"{column.symbol}_{label}"]
            drives = value <= 0.0 and column.symbol != "offset"
            if drives or judged == "not":
                faults.append((float((value if drives else abs(value)) / max(std, 1e-300)), column.symbol))
        if faults:
            at_fault.append((joint, min(faults)[1]))
    return at_fault


def _numbers(columns: Columns) -> int:
    """Number of coefficients and settings."""
    lengths, velocities = {c.length for c in columns} - {0.0}, {c.velocity for c in columns} - {0.0}
    return len(columns) + len(lengths) + len(velocities)
