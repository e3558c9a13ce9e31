"""The friction model of each joint, then filter and estimator, then the fit that has to confirm them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from exoid.errors import ExoidError
from exoid.estimate.estimate import Estimate
from exoid.identification.identify import identify
from exoid.leg import Leg
from exoid.signals import Recording, ZeroPhase
from exoid.torques import Armature

from .candidates import Candidate, estimator_candidates, filter_candidates
from .fixed_friction import held_out_errors
from .patterns import PLAIN, describe, terms_of, zeros_of
from .per_joint import Columns, JointByJoint
from .scores import Score, best_of


class JointFriction(NamedTuple):
    """Friction model that was chosen for a joint.

    Attributes:
        joint: Name of the joint.
        coefficients: Symbols of its coefficients, all positive but the offset.
        presliding: Presliding length [rad]; 0 for none.
        stribeck_velocity: Stribeck velocity [rad/s]; 0 for none.
        text: The same in a few words.
    """

    joint: str
    coefficients: tuple[str, ...]
    presliding: float
    stribeck_velocity: float
    text: str

    @classmethod
    def of(cls, joint: str, columns: Columns) -> JointFriction:
        """Describe the friction of a joint."""
        lengths, velocities = [c.length for c in columns], [c.velocity for c in columns]
        symbols = tuple(column.symbol for column in columns)
        return cls(joint, symbols, max(lengths, default=0.0), max(velocities, default=0.0), describe(columns))

    def to_json(self) -> dict[str, Any]:
        """Turn it into what JSON can hold."""
        return {
            "joint": self.joint,
            "coefficients": list(self.coefficients),
            "presliding": self.presliding,
            "stribeck_velocity": self.stribeck_velocity,
        }


class Chosen(NamedTuple):
    """Choice for all joints.

    Attributes:
        scores: Scores of all candidates.
        chosen: Index of the one that was chosen.
        joints: Friction model of each joint, n of them.
        estimate: The fit that confirmed it.
    """

    scores: tuple[Score, ...]
    chosen: int
    joints: tuple[JointFriction, ...]
    estimate: Estimate


@dataclass(frozen=True)
class _Bench:
    """Where candidates are compared."""

    search: JointByJoint
    folds: int
    cutoff: float

    def candidate(self, name: str, chosen: Sequence[Columns], like: Candidate | None = None) -> Candidate:
        """Candidate with these friction models, and the filter and estimator of another."""
        leg = self.search.leg
        pairs = list(zip(chosen, leg.joint_names, leg.joint_labels, strict=True))
        friction = tuple(term for columns, joint, _ in pairs for term in terms_of(columns, joint))
        zero = tuple(name for columns, _, label in pairs for name in zeros_of(columns, label))
        like = like or Candidate("", (), preparation=ZeroPhase(self.cutoff))
        return replace(like, name=name, terms=(*friction, Armature()), zero=zero)

    def score(self, candidate: Candidate, chosen: Sequence[Columns]) -> Score:
        """Predict what is held out."""
        search = self.search
        numbers = len(search.base) + sum(_numbers(columns) for columns in chosen)
        try:
            found = held_out_errors(
                search.model,
                search.recordings,
                candidate.preparation,
                chosen,
                search.base[: len(search.leg.parameter_names)],
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
) -> Chosen:
    """Choose the friction of each joint, then filter and estimator.

    Args:
        leg: The leg.
        recordings: The recordings.
        folds: Number of folds.
        cutoff: Cut-off frequency of the filter behind which torques are compared [Hz].
        tune: Whether to go on to filters and estimators.
        progress: Called with the share done.

    Returns:
        The choice, whose coefficients are positive and determined by the recordings.

    Raises:
        ExoidError: The recordings do not determine the rigid bodies.
    """
    preparation = ZeroPhase(cutoff)
    first = JointByJoint(leg, recordings, preparation, folds, progress=lambda share: progress(0.3 * share))
    second = JointByJoint(
        leg, recordings, preparation, folds, progress=lambda share: progress(0.3 + 0.3 * share), offset_sweeps=2
    )
    benches = [_Bench(search, folds, cutoff) for search in (first, second)]
    found = []
    for each in benches:
        each.search.run()
        found.append(each.score(each.candidate("by joint", each.search.chosen), each.search.chosen))
    better = best_of(found)  # the search may end elsewhere if it starts elsewhere
    bench, search = benches[better], benches[better].search
    plain: list[Columns] = [PLAIN] * len(leg.joint_names)
    scores = [bench.score(bench.candidate("coulomb", plain), plain), found[better]]
    progress(0.65)
    chosen = 1
    for more in (filter_candidates, estimator_candidates) if tune else ():
        later = more(scores[chosen].candidate)
        tried = [bench.score(candidate, search.chosen) for candidate in later]
        choice = best_of([scores[chosen], *tried])
        chosen = chosen if choice == 0 else len(scores) + choice - 1
        scores += tried
    progress(0.75)
    estimate = fit_candidate(leg, recordings, scores[chosen].candidate)
    while faults := _faults(search, estimate):  # each round bans a coefficient for good
        for joint, symbol in faults:
            search.ban(joint, symbol)
        again = bench.candidate(scores[chosen].candidate.name, search.chosen, scores[chosen].candidate)
        scores[chosen] = bench.score(again, search.chosen)
        estimate = fit_candidate(leg, recordings, again)
        progress(0.9)
    progress(1.0)
    joints = tuple(JointFriction.of(*pair) for pair in zip(leg.joint_names, search.chosen, strict=True))
    return Chosen(tuple(scores), chosen, joints, estimate)


def fit_candidate(
    leg: Leg, recordings: Recording | Sequence[Recording], candidate: Candidate, *, nonnegative: bool = False
) -> Estimate:
    """Identify with a candidate; coefficients that it leaves out are held at zero.

    Args:
        leg: The leg.
        recordings: The recordings.
        candidate: The candidate.
        nonnegative: Whether to bound friction and rotor inertias by zero.

    Returns:
        The estimate.
    """
    return identify(
        leg,
        recordings,
        candidate.terms,
        candidate.estimator,
        preparation=candidate.preparation,
        known=dict.fromkeys(candidate.zero, 0.0) or None,
        nonnegative=nonnegative,
    )


def _faults(search: JointByJoint, estimate: Estimate) -> list[tuple[int, str]]:
    """Joint and symbol of each friction coefficient that is not positive, or that the recordings do not determine.

    Of one joint only the least determined: without it, the others may be good.
    """
    found = []
    figures = zip(estimate.values, estimate.std, estimate.identifiability, strict=True)
    numbers = dict(zip(estimate.names, figures, strict=True))
    for joint, (columns, label) in enumerate(zip(search.chosen, search.leg.joint_labels, strict=True)):
        faults: list[tuple[float, str]] = []
        for column in columns:
            value, std, judged = numbers[f"{column.symbol}_{label}"]
            drives = value <= 0.0 and column.symbol != "offset"
            if drives or judged == "not":
                faults.append((float((value if drives else abs(value)) / max(std, 1e-300)), column.symbol))
        if faults:
            found.append((joint, min(faults)[1]))
    return found


def _numbers(columns: Columns) -> int:
    """Number of coefficients and settings."""
    lengths, velocities = {c.length for c in columns} - {0.0}, {c.velocity for c in columns} - {0.0}
    return len(columns) + len(lengths) + len(velocities)
