"""Which terms predict best what they have not seen."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from exoid.errors import BadArgumentError, ExoidError, NotIdentifiableError, NotSupportedError
from exoid.estimate.estimate import Estimate
from exoid.identification.estimators import wls
from exoid.identification.gather import begin, gather
from exoid.identification.identify import FitOptions, identify
from exoid.identification.recording_summary import unmeasured_joints
from exoid.leg.leg import Leg
from exoid.regression.parameters import PriorKnowledge
from exoid.signals import Recording, ZeroPhase
from exoid.tools.tables import make_table, to_text
from exoid.torques import Armature, Term
from exoid.torques.catalog import DEFAULT_TERMS, TERMS, radians

from .by_joint import Candidate, select_by_joint
from .patterns import JointFriction
from .per_joint import Search


@dataclass(frozen=True, eq=False, repr=False)
class Selection:
    """What was tried, how well it predicted, and what was chosen; prints itself as a table.

    Attributes:
        leg: The leg.
        candidates: Friction models with their scores, in the order in which they were tried.
        chosen: Index of the one that was chosen.
        cutoff: Cut-off frequency of the filter of all fits [Hz].
        folds: Number of folds.
        joints: Friction model of each joint, (n,).
        estimate: The fit of the recordings that confirmed the choice.
    """

    leg: Leg
    candidates: tuple[Candidate, ...]
    chosen: int
    cutoff: float
    folds: int
    joints: tuple[JointFriction, ...]
    estimate: Estimate

    @property
    def candidate(self) -> Candidate:
        """The one that was chosen."""
        return self.candidates[self.chosen]

    @property
    def warnings(self) -> tuple[str, ...]:
        """What speaks against the choice."""
        mine = self.candidate.fast
        best = min(self.candidates, key=lambda one: float(np.nan_to_num(one.fast, nan=np.inf)))
        if np.isnan(mine) or best.fast > 1.0:  # a constant predicts better
            return ("the slower seconds do not suffice to predict the faster ones: record longer, at several speeds",)
        if mine <= 1.15 * best.fast:  # set by hand: closer ones are taken for equal
            return ()
        text = f"{self.candidate.name!r} transfers badly to faster motion: NRMSE {mine:.4f} there, {best.fast:.4f}"
        return (f"{text} with {best.name!r}; record faster motions before you rely on it there",)

    def identify(self, recordings: Recording | Sequence[Recording]) -> Estimate:
        """Identify with what was chosen; see :func:`exoid.identify`.

        Args:
            recordings: Recordings to identify from.

        Returns:
            The estimate.
        """
        return self.candidate.fit(self.leg, recordings, self.cutoff)

    def to_json(self) -> dict[str, Any]:
        """Turn a selection into what JSON can hold.

        Returns:
            Scores of all candidates, and the choice.
        """
        joints = [{**joint._asdict(), "coefficients": list(joint.coefficients)} for joint in self.joints]
        return {
            "cutoff": self.cutoff,
            "folds": self.folds,
            "joint_names": list(self.leg.joint_names),
            "chosen": self.candidate.name,
            "terms": [TERMS.to_json(term) for term in self.candidate.terms],
            "known": dict(self.candidate.known),
            "joints": [{k: x for k, x in joint.items() if x is not False} for joint in joints],
            "warnings": list(self.warnings),
            "candidates": [candidate.to_json() for candidate in self.candidates],
        }

    def __repr__(self) -> str:
        """Print as a table."""
        headers = ("candidate", "fits", *self.leg.joint_labels, "mean", "fast")
        rows = []
        for k, one in enumerate(self.candidates):
            name = f"* {one.name}" if k == self.chosen else f"  {one.name}"
            if one.failure:
                rows.append((name, "failed", *("",) * (len(one.nrmse) + 2)))
                continue
            figures = (*one.nrmse, one.mean, one.fast)
            rows.append((name, str(one.numbers), *("" if np.isnan(figure) else f"{figure:.4f}" for figure in figures)))
        title = (
            f"NRMSE of rows not fitted: {self.folds} blocked folds, torques behind {self.cutoff:g} Hz; "
            "fast: mean for the fastest 30 % of seconds, predicted from the others"
        )
        return to_text(
            "Friction that the recordings determine and that dissipates at every speed:",
            make_table(("joint", "friction"), [(joint.joint, joint.text) for joint in self.joints]),
            title,
            make_table(headers, rows),
            f"* chosen: {self.candidate.name}",
            *(f"{one.name}: {one.failure}" for one in self.candidates if one.failure),
            *(f"warning: {warning}" for warning in self.warnings),
        )


def select_terms(
    leg: Leg,
    recordings: Recording | Sequence[Recording],
    *,
    folds: int = 5,
    cutoff: float | None = None,
    beside: Sequence[Term] = (),
    known: Mapping[str, float] | None = None,
    progress: Callable[[float], None] | None = None,
) -> Selection:
    """Choose friction by how well it predicts stretches that it was not fitted to.

    The friction of each joint is chosen by itself, with the fewest numbers within one standard error of the best
    (docs/friction.md). Each recording is cut into as many stretches as there are folds; each is predicted from the
    others.

    Args:
        leg: The leg.
        recordings: One or several. Nothing else is looked at.
        folds: Number of folds, at least 3.
        cutoff: Cut-off frequency of the filter [Hz]; None for at most 8 Hz, by the noise of the angles.
        beside: Terms that every model has besides the friction and rotors that are chosen, such as a spring over two
            joints.
        known: Values of rigid bodies and rotors that every model holds, by name: {"Y2": 0.0} for a symmetric shank.
        progress: Called with the share done.

    Returns:
        The scores of all candidates, and the choice.

    Raises:
        ExoidError: There are too few folds, a joint stands still, its torque is dead or was not measured, or none of
            the candidates can be fitted.

    Example:
        >>> est = select_terms(leg, recording).estimate  # doctest: +SKIP
    """
    several = [recordings] if isinstance(recordings, Recording) else list(recordings)
    if folds < 3 or not several:
        what = f"{len(several)} recordings, {folds} folds"
        raise BadArgumentError(what, remedy="pass recordings, and at least 3 folds")
    if not all(isinstance(recording, Recording) for recording in several):
        raise BadArgumentError("poses cannot be cut into stretches of time", remedy="pass recordings only")
    if leg.base_rows:
        remedy = 'pass terms to identify, or select with base="moving" and recordings without wrenches and contacts'
        raise NotSupportedError("friction is not selected beside rows of the base", remedy=remedy)
    problem = begin(leg, several, (Armature(), *beside), wls, PriorKnowledge(known or {}))
    group = gather(problem, wls, own=None, preparation=None, cutoff=cutoff, check=False).single
    assert isinstance(group.preparation, ZeroPhase)
    several, cutoff = group.motions, group.preparation.cutoff
    if missing := unmeasured_joints(leg.joint_names, group.summaries):
        what = f"the friction of {', '.join(missing)} cannot be chosen: that torque was not measured"
        remedy = "lock these joints in the leg"
        command = "name the joints that were measured by --joints"
        raise NotIdentifiableError(what, remedy=remedy, command=command, joints=missing)
    late = {}  # delays of torques, if all are late: friction would be chosen to imitate them
    with suppress(ExoidError):
        # One joint that is late, or torques that are early, may be friction of another form.
        how: FitOptions = {"preparation": ZeroPhase(cutoff), "delay": "auto", "check": False}
        delays = identify(leg, several, (*DEFAULT_TERMS, *beside), **how).torque_delays
        late = dict(enumerate(delays.tolist())) if (delays > 0.0).all() else {}
    report = progress or (lambda share: None)
    search = Search(leg, several, cutoff, folds, report, tuple(beside), late, problem.given.known)
    candidates, chosen, columns, estimate = select_by_joint(search)
    joints = tuple(map(JointFriction.of, leg.joint_names, columns, radians(leg).tolist()))
    return Selection(leg, tuple(candidates), chosen, cutoff, folds, joints, estimate)
