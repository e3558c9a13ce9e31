"""Which terms, filter and estimator predict best what they have not seen."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate.estimate import Estimate
from exoid.estimate.validation import Validation, validate
from exoid.identification.estimators import find_estimator
from exoid.identification.fitting import Fitted, Start, Task
from exoid.identification.group_rows import Group
from exoid.identification.identify import fit_model
from exoid.identification.recording_summary import (
    refuse_dead_torques,
    refuse_still_joints,
    summarize,
    unmeasured_joints,
)
from exoid.identification.unmeasured import terms_where_measured
from exoid.leg.leg import Leg
from exoid.regression.parameters import PriorKnowledge
from exoid.signals import Recording
from exoid.signals.default_preparation import highest_cutoff
from exoid.signals.preparation_names import preparation_to_json
from exoid.tools.tables import DataTable, make_table, to_text
from exoid.torques import Term, TorqueModel
from exoid.torques.catalog import term_to_json

from .by_joint import JointFriction, fit_candidate, select_by_joint
from .candidates import Candidate, estimator_candidates, filter_candidates
from .cross_validation import Errors, Split, blocked_folds, evaluation, fast_blocks, held_out
from .scores import Score, best_of, least, standard_error

FOLDS = 5
"""Stretches of each recording that are predicted in turn."""

TRANSFERS = 1.15
"""An extrapolation error beyond this multiple of the best candidate's is warned of."""


@dataclass(frozen=True, eq=False, repr=False)
class Selection:
    """What was tried, how well it predicted, and what was chosen; prints itself as a table.

    Attributes:
        leg: The leg.
        joint_names: Joints, (n,).
        scores: Scores of all candidates, in the order in which they were tried.
        chosen: Index of the one that was chosen.
        cutoff: Cut-off frequency of the filter behind which torques were compared [Hz].
        folds: Number of folds.
        joints: Friction model of each joint, (n,); none where whole candidates were given to choose from.
        estimate: The fit of the recordings that confirmed the choice; None where candidates were given.
    """

    leg: Leg
    joint_names: tuple[str, ...]
    scores: tuple[Score, ...]
    chosen: int
    cutoff: float
    folds: int
    joints: tuple[JointFriction, ...] = ()
    estimate: Estimate | None = None

    @property
    def candidate(self) -> Candidate:
        """The one that was chosen."""
        return self.scores[self.chosen].candidate

    @property
    def warnings(self) -> tuple[str, ...]:
        """What speaks against the choice."""
        mine = self.scores[self.chosen].fast
        best = min(self.scores, key=lambda score: float(np.nan_to_num(score.fast, nan=np.inf)))
        least = best.fast
        if np.isnan(mine):
            return ("the slower seconds do not suffice to predict the faster ones: record longer, at several speeds",)
        if mine <= TRANSFERS * least:
            return ()
        return (
            f"{self.candidate.name!r} transfers badly to faster motion: NRMSE {mine:.4f} there, "
            f"{least:.4f} with {best.candidate.name!r}; record faster motions before you rely on it there",
        )

    def identify(self, recordings: Recording | Sequence[Recording]) -> Estimate:
        """Identify with what was chosen; see :func:`exoid.identify`.

        Args:
            recordings: Recordings to identify from.

        Returns:
            The estimate.
        """
        return fit_candidate(self.leg, recordings, self.candidate, nonnegative=not self.joints)

    def validate(self, estimate: Estimate, recording: Recording) -> Validation:
        """Validate behind the filter at :attr:`cutoff`, whatever filter was chosen for the fit.

        Args:
            estimate: An estimate by :meth:`identify`.
            recording: A recording that is not fitted.

        Returns:
            Measured and predicted torque.
        """
        preparation = evaluation(estimate.preparation, self.cutoff, recording.sample_rate)
        return validate(estimate, recording, preparation=preparation)

    def to_json(self) -> dict[str, Any]:
        """Turn a selection into what JSON can hold.

        Returns:
            Scores of all candidates, and the choice.
        """
        return {
            "cutoff": self.cutoff,
            "folds": self.folds,
            "joint_names": list(self.joint_names),
            "chosen": self.candidate.name,
            "terms": [term_to_json(term) for term in self.candidate.terms],
            "estimator": self.candidate.estimator,
            "preparation": preparation_to_json(self.candidate.preparation),
            "zero": list(self.candidate.zero),
            "joints": [joint.to_json() for joint in self.joints],
            "warnings": list(self.warnings),
            "candidates": [
                {
                    "name": score.candidate.name,
                    "numbers": score.numbers,
                    "nrmse": _list(score.nrmse),
                    "folds": _list(score.folds),
                    "fast": _list(score.extrapolation),
                    "failure": score.failure,
                }
                for score in self.scores
            ],
        }

    def __repr__(self) -> str:
        """Name the choice."""
        return f"Selection({self.candidate.name!r} of {len(self.scores)})"

    def __str__(self) -> str:
        """Print as a table."""
        headers = ("candidate", "fits", *self.leg.joint_labels, "mean", "± to best", "fast")
        best = least(self.scores)
        rows = [_row(k == self.chosen, score, self.scores[best]) for k, score in enumerate(self.scores)]
        title = (
            f"NRMSE of rows not fitted: {self.folds} blocked folds, torques behind {self.cutoff:g} Hz; "
            "fast: mean for the fastest 30 % of seconds, predicted from the others"
        )
        joints = [(joint.joint, joint.text) for joint in self.joints]
        friction: tuple[DataTable | str, ...] = (
            "Friction that the recordings determine and that dissipates at every speed:",
            make_table(("joint", "friction"), joints),
        )
        return to_text(
            *(friction if joints else ()),
            title,
            make_table(headers, rows),
            f"* chosen: {self.candidate.name}, which fits the fewest numbers of those whose mean is within one "
            f"standard error of the best, {self.scores[best].candidate.name}",
            *(f"{score.candidate.name}: {score.failure}" for score in self.scores if score.failure),
            *(f"warning: {warning}" for warning in self.warnings),
        )


def select_terms(
    leg: Leg,
    recordings: Recording | Sequence[Recording],
    candidates: Sequence[Candidate] | None = None,
    *,
    folds: int = FOLDS,
    cutoff: float | None = None,
    tune: bool = True,
    beside: Sequence[Term] = (),
    progress: Callable[[float], None] | None = None,
) -> Selection:
    """Compare ways to identify by how well they predict stretches of the recordings that they were not fitted to.

    By default the friction of each joint is chosen by itself (docs/friction.md): which coefficients it has, presliding
    length and Stribeck velocity. All coefficients are positive, so that friction dissipates at every speed and under
    every load, and are determined by the recordings. The error of a joint's friction counts twice: in stretches of time
    that were not fitted, and in samples faster than all that were fitted.

    With candidates, these are compared as they are, with friction and rotor inertias bounded by zero.

    Each recording is cut into as many stretches as there are folds; each is predicted from the others. Rows within
    0.1 s of those tested are not fitted. Hidden states run through the whole recording: they depend on angles alone.
    Of all candidates whose error exceeds the best one's by no more than the standard error of the difference (paired,
    fold by fold), the one with the fewest numbers is chosen, of equals the first. Other filters, and then other
    estimators, are tried for the terms that were chosen, and compared in the same way.

    Args:
        leg: The leg.
        recordings: One or several. Nothing else is looked at.
        candidates: Candidates to compare; None to choose the friction of each joint.
        folds: Number of folds, at least 3.
        cutoff: Cut-off frequency of the filter behind which torques are compared, and of the default candidates [Hz];
            None for 8 Hz, and a fifth of the sampling rate of logs below 20 Hz.
        tune: Whether to go on to filters and estimators.
        beside: Terms that every model has besides the friction and rotors that are chosen, such as a spring over two
            joints. Candidates get them too.
        progress: Called with the share done.

    Returns:
        The scores of all candidates, and the choice.

    Raises:
        ExoidError: There are no candidates, too few folds, a joint stands still, its torque is dead or was not
            measured, or none of the candidates can be fitted.

    Example:
        >>> est = select_terms(leg, recording).identify(recording)  # doctest: +SKIP
    """
    several = _checked_recordings(recordings, candidates, folds)
    if cutoff is None:
        cutoff = highest_cutoff(min(recording.sample_rate for recording in several))
    beside = tuple(beside)
    missing = _unmeasured(leg, several, beside)
    if candidates is None:
        if missing:
            raise ExoidError(
                f"the friction of {', '.join(missing)} cannot be chosen: that torque was not measured",
                remedy="lock these joints in the leg, or pass candidates",
                command="name the joints that were measured by --joints",
            )
        report = progress or (lambda share: None)
        found = select_by_joint(leg, several, folds=folds, cutoff=cutoff, tune=tune, progress=report, beside=beside)
        return Selection(leg, leg.joint_names, found.scores, found.chosen, cutoff, folds, found.joints, found.estimate)
    bench = _Bench(leg, several, folds, cutoff, missing)
    scores, chosen = bench.compare([bench.completed(candidate, beside) for candidate in candidates], tune, progress)
    return Selection(leg, leg.joint_names, scores, chosen, cutoff, folds)


def _checked_recordings(
    recordings: Recording | Sequence[Recording], candidates: Sequence[Candidate] | None, folds: int
) -> list[Recording]:
    """List the recordings; raise an error if there are none, no candidates, or too few folds."""
    several = [recordings] if isinstance(recordings, Recording) else list(recordings)
    if folds < 3 or not several or (candidates is not None and not candidates):
        count = "default" if candidates is None else str(len(candidates))
        raise ExoidError(
            f"{count} candidates, {len(several)} recordings, {folds} folds",
            remedy="pass candidates (or None for the default ones), recordings, and at least 3 folds",
        )
    if not all(isinstance(recording, Recording) for recording in several):
        raise ExoidError("poses cannot be cut into stretches of time", remedy="pass recordings only")
    return several


def _unmeasured(leg: Leg, recordings: Sequence[Recording], beside: tuple[Term, ...]) -> tuple[str, ...]:
    """Labels of joints whose torque was not measured; raise an error if a joint stands still or its torque is dead."""
    model = TorqueModel.at_start(leg, beside)
    summaries = [summarize(model, recording, for_cutoff=False) for recording in recordings]
    refuse_still_joints(model, summaries)
    refuse_dead_torques(model, summaries)
    return unmeasured_joints(leg.joint_labels, [summaries])


class _Bench(NamedTuple):
    """Where candidates are tried."""

    leg: Leg
    recordings: list[Recording]
    folds: int
    cutoff: float
    unmeasured: tuple[str, ...] = ()

    def completed(self, candidate: Candidate, beside: tuple[Term, ...]) -> Candidate:
        """Give a candidate the terms beside, and leave out those that unmeasured joints cannot have."""
        terms = (*candidate.terms, *beside)
        if self.unmeasured:
            terms = terms_where_measured(terms, self.leg, self.unmeasured)
        return replace(candidate, terms=terms)

    def compare(
        self, candidates: Sequence[Candidate], tune: bool, progress: Callable[[float], None] | None
    ) -> tuple[tuple[Score, ...], int]:
        """Try candidates, then other filters and estimators for the best."""
        scores = self.scores(candidates, _part(progress, 0.0, 0.6 if tune else 1.0))
        chosen = best_of(scores)
        rounds = ((0.6, 0.85, partial(filter_candidates, cutoff=self.cutoff)), (0.85, 1.0, estimator_candidates))
        for first, last, more in rounds if tune else ():
            later = self.scores(more(scores[chosen].candidate), _part(progress, first, last))
            choice = best_of((scores[chosen], *later))
            chosen = chosen if choice == 0 else len(scores) + choice - 1
            scores = (*scores, *later)
        return scores, chosen

    def scores(self, candidates: Sequence[Candidate], progress: Callable[[float], None] | None) -> tuple[Score, ...]:
        """Try candidates one by one."""
        splits, fast = blocked_folds(self.recordings, self.folds), fast_blocks(self.recordings)
        found = []
        for index, candidate in enumerate(candidates):
            found.append(self._score(candidate, splits, fast))
            if progress is not None:
                progress((index + 1) / len(candidates))
        return tuple(found)

    @property
    def _without_rows(self) -> tuple[str, ...]:
        """Names of the unmeasured joints, which are known by their labels."""
        leg = self.leg
        return tuple(
            name for name, label in zip(leg.joint_names, leg.joint_labels, strict=True) if label in self.unmeasured
        )

    def _score(self, candidate: Candidate, splits: Sequence[Split], fast: Split) -> Score:
        """Fit to all rows first: fits to most of them begin there, which changes where they end by nothing."""
        nothing = np.full(len(self.leg.joint_names), np.nan)
        group = Group("", self.leg, self.recordings, candidate.preparation, self._without_rows)
        estimator = find_estimator(candidate.estimator)
        known = PriorKnowledge.of(dict.fromkeys(candidate.zero, 0.0), None, nonnegative=True)
        try:
            model = TorqueModel.at_start(self.leg, candidate.terms, known.known_names)
            task = Task((group,), (model,), candidate.terms, estimator, prior_knowledge=known)
            whole = fit_model(task)
            start = Start.at(whole)
            each = [held_out(task, self.recordings, split, start, self.cutoff) for split in splits]
        except ExoidError as error:
            return Score.failed(candidate, len(nothing), len(splits), error.what)
        if drives := _driving(whole):
            return Score.failed(candidate, len(nothing), len(splits), drives)
        try:
            quick = held_out(task, self.recordings, fast, start, self.cutoff)
            extrapolation = quick.ratio(quick)
        except ExoidError:
            extrapolation = nothing
        return Score(candidate, len(whole.values) + len(whole.nonlinear), *_summary(each), extrapolation)


def _driving(fitted: Fitted) -> str:
    """Say where Stribeck friction would drive its joint at low speed; empty if nowhere."""
    values = dict(zip(fitted.models[0].names, fitted.values.tolist(), strict=True))
    for name, value in values.items():
        rest = values.get(f"c0{name[2:]}", 0.0)
        if name.startswith("cs_") and (value + rest < 0.0 or rest < 0.0):
            return f"{name} = {value:.3g} N·m beside c0 = {rest:.3g} N·m would drive the joint"
    return ""


def _summary(each: Sequence[Errors]) -> tuple[FloatArray, FloatArray]:
    """NRMSE of each joint over all folds, and of each fold, all over the spread of the torque in the whole."""
    whole = Errors.total(each)
    return whole.ratio(whole), np.array([np.mean(errors.ratio(whole)[whole.measured]) for errors in each])


def _row(chosen: bool, score: Score, best: Score) -> tuple[str, ...]:
    name = f"* {score.candidate.name}" if chosen else f"  {score.candidate.name}"
    if score.failure:
        return (name, "failed", *("",) * (len(score.nrmse) + 3))
    figures = (*score.nrmse, score.mean, standard_error(score, best), score.fast)
    return (name, str(score.numbers), *("" if np.isnan(figure) else f"{figure:.4f}" for figure in figures))


def _part(progress: Callable[[float], None] | None, first: float, last: float) -> Callable[[float], None] | None:
    """Progress of a part of the work as progress of the whole."""
    return None if progress is None else lambda share: progress(first + (last - first) * share)


def _list(array: FloatArray) -> list[float | None]:
    return [value if np.isfinite(value) else None for value in array.tolist()]
