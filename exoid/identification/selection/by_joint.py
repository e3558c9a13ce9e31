"""The friction model of each joint, then filter and estimator, then the fit that has to confirm them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from exoid.errors import ExoidError, NotIdentifiableError
from exoid.estimate.estimate import Estimate
from exoid.signals import ZeroPhase
from exoid.torques import Armature, Term

from .candidates import Candidate, best_of
from .design import base_model
from .held_out import held_out_errors
from .patterns import ALWAYS, PLAIN, Columns, absent, numbers_of, terms_of, zeros_of
from .per_joint import Choice, Found, Search, search_joint_by_joint


class Chosen(NamedTuple):
    """Choice for all joints."""

    candidates: tuple[Candidate, ...]  # all that were compared
    chosen: int  # index of the one that was chosen
    columns: tuple[Columns, ...]  # friction of each joint, n of them
    estimate: Estimate  # the fit that confirmed it


def select_by_joint(search: Search, *, tune: bool, progress: Callable[[float], None]) -> Chosen:
    """Choose the friction of each joint, then filter and estimator."""
    found = _searched(search, progress)
    plain = found.choice._replace(columns=(PLAIN,) * len(search.leg.joint_names))
    candidates = [_scored(search, "coulomb", plain), _scored(search, "by joint", found.choice)]
    progress(0.65)
    chosen = 1
    for which in (0, 1) if tune else ():
        tried = [_score(search, one, found.choice) for one in candidates[chosen].others(search.cutoff)[which]]
        choice = best_of([candidates[chosen], *tried])
        chosen = chosen if choice == 0 else len(candidates) + choice - 1
        candidates += tried
    progress(0.75)
    while True:
        try:
            estimate = candidates[chosen].fit(search.leg, search.recordings)
        except NotIdentifiableError as error:
            faults = _indistinct(found, error)
            if not faults:
                raise
        else:
            faults = _faults(found, estimate)
        if not faults:
            break
        for joint, symbol in faults:  # each round bans a coefficient for good
            found = found.without(joint, symbol)
        candidates[chosen] = _scored(search, candidates[chosen].name, found.choice, candidates[chosen])
        progress(0.9)
    progress(1.0)
    return Chosen(tuple(candidates), chosen, found.choice.columns, estimate)


def _searched(search: Search, progress: Callable[[float], None]) -> Found:
    """Search from two starts, as the search may end elsewhere if it starts elsewhere, and take the better end."""
    ends = []
    for begin, offset_sweeps in ((0.0, 0), (0.3, 2)):
        report = partial(lambda first, share: progress(first + 0.3 * share), begin)
        ends.append(search_joint_by_joint(replace(search, offset_sweeps=offset_sweeps, progress=report)))
    return ends[best_of([_scored(search, "by joint", end.choice) for end in ends])]


def _scored(search: Search, name: str, choice: Choice, like: Candidate | None = None) -> Candidate:
    """Candidate with these friction models, and the filter and estimator of another, with its held-out errors."""
    friction: list[Term] = []
    zero: list[str] = []
    leg = search.leg
    for columns, joint, label in zip(choice.columns, leg.joint_names, leg.joint_labels, strict=True):
        friction += terms_of((*columns, *absent(columns)), joint)
        zero += [*zeros_of(columns, label), *(f"{column.symbol}_{label}" for column in absent(columns))]
    terms = (*friction, Armature(), *search.beside)
    estimator, preparation = ("wls", ZeroPhase(search.cutoff)) if like is None else (like.estimator, like.preparation)
    return _score(search, Candidate(name, terms, tuple(zero), preparation, estimator), choice)


def _score(search: Search, candidate: Candidate, choice: Choice) -> Candidate:
    """Predict what is held out, with joints loaded by the rigid bodies of a choice."""
    try:
        found = held_out_errors(
            base_model(search.leg, search.beside),
            search.recordings,
            candidate.preparation,
            choice.columns,
            choice.base[: len(search.leg.parameter_names)],
            folds=search.folds,
            cutoff=search.cutoff,
            robust=candidate.estimator == "huber",
        )
    except ExoidError as error:
        nothing = np.full(len(choice.columns), np.nan)
        failed = np.full(search.folds, np.nan)
        return replace(candidate, nrmse=nothing, folds=failed, extrapolation=nothing, failure=error.what)
    failure = "" if np.isfinite(found.folds).all() else "rows are too few for all folds"
    numbers = len(choice.base) + numbers_of(choice.columns)
    return replace(candidate, numbers=numbers, failure=failure, **found._asdict())


def _indistinct(found: Found, error: NotIdentifiableError) -> list[tuple[int, str]]:
    """Joint and symbol of the coefficients, but for c0 and d, that the whole fit cannot tell from others."""
    pairs = zip(found.choice.columns, found.search.leg.joint_labels, strict=True)
    return [
        (joint, column.symbol)
        for joint, (columns, label) in enumerate(pairs)
        for column in columns
        if column.symbol not in ALWAYS and f"{column.symbol}_{label}" in error.parameters
    ]


def _faults(found: Found, estimate: Estimate) -> list[tuple[int, str]]:
    """Joint and symbol of each friction coefficient that drives, or that the recordings do not determine."""
    # Of one joint only the least determined: without it, the others may be good.
    at_fault = []
    figures = zip(estimate.values, estimate.std, estimate.identifiability, strict=True)
    numbers = dict(zip(estimate.names, figures, strict=True))
    for joint, (columns, label) in enumerate(zip(found.choice.columns, found.search.leg.joint_labels, strict=True)):
        faults: list[tuple[float, str]] = []
        for column in columns:
            value, std, judged = numbers[f"{column.symbol}_{label}"]
            # A negative cs dissipates if c0 + cs does.
            rest = numbers[f"c0_{label}"][0] if column.symbol == "cs" else 0.0
            drives = value + rest <= 0.0 and column.symbol != "offset"
            if drives or (judged == "not" and column.symbol not in ALWAYS):
                faults.append((float((value if drives else abs(value)) / max(std, 1e-300)), column.symbol))
        if faults:
            at_fault.append((joint, min(faults)[1]))
    return at_fault
