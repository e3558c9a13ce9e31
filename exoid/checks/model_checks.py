"""Checks of a fit against faults that nuisance columns describe, chosen one after the other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.findings import Finding, Severity
from exoid.torques import TorqueModel

from .corrections import CORRECTED, corrected
from .nuisances import Nuisance, always, column_layout, nuisances
from .sample import Checked, gather
from .score import HALF_WIDTH, Evidence, Score, State
from .sentences import describe_fault

FALSE_ALARMS = 0.005
"""Probability with which some fault would be found in a log without any."""

LARGE_GAIN = 0.05
"""A fault that explains more than this part of the squared residuals is tested with the noise that is left then."""

SMALLEST_MOVE = 0.5
"""A fault matters if it moves a parameter by more than so many half widths of its interval."""

DOUBTFUL_MOVE = 0.25
"""A fault that matters makes all parameters doubtful that it moves by more than this."""

STEPS = 6
"""Faults that are looked for at most."""

SEVERE = 10.0
"""A fault that moves a parameter by so many half widths is an error."""

LARGEST = {"torque-delay": 0.1, "torque-scale": 2.0, "angle-offset": 0.5, "angle-scale": 0.5, "gravity-direction": 0.5}
"""Largest part of a fault that is taken out at once: beyond, one step of Gauss and Newton is not to be trusted."""


class Fault(NamedTuple):
    """A fault that was accepted.

    Attributes:
        nuisance: The fault.
        applied: Part of it that was taken out of the recordings.
    """

    nuisance: Nuisance
    applied: float = 0.0

    @property
    def columns(self) -> tuple[int, ...]:
        """Columns that stay in the fit; none where the fault is taken out of the recordings."""
        return () if is_corrected(self.nuisance) else self.nuisance.columns


class FaultSize(NamedTuple):
    """Size of a fault beside all others, and what it does to the parameters.

    Attributes:
        fault: The fault.
        delta: Estimate, (m,).
        std: Standard deviations, (m,).
        p_value: Probability of a fault as large as this in noise alone.
        move: Change of the parameters when the fault is taken into account, (P,).
        half: Half widths of the parameters' intervals, (P,).
    """

    fault: Fault
    delta: FloatArray
    std: FloatArray
    p_value: float
    move: FloatArray
    half: FloatArray

    @property
    def moves(self) -> FloatArray:
        """Changes of the parameters in half widths, (P,)."""
        return np.divide(np.abs(self.move), self.half, out=np.zeros_like(self.move), where=self.half > 0.0)

    def moving_at_least(self, total: FloatArray) -> FaultSize:
        """Blame this fault for what all faults together move more than it does alone.

        Args:
            total: Change of the parameters by all faults, (P,).

        Returns:
            The same fault.
        """
        return self._replace(move=np.where(np.abs(total) > np.abs(self.move), total, self.move))


def is_corrected(nuisance: Nuisance) -> bool:
    """Say whether a fault is taken out of the recordings.

    Args:
        nuisance: The fault.

    Returns:
        Whether it is; else its columns stay in the fit.
    """
    return nuisance.kind in CORRECTED and not nuisance.group


def findings_of(model: TorqueModel, sizes: Sequence[FaultSize]) -> tuple[Finding, ...]:
    """Describe faults that were found.

    Args:
        model: Torque model.
        sizes: The faults with their sizes.

    Returns:
        One finding for each kind and joint, with the parameters that it makes doubtful.
    """
    findings: dict[tuple[str, str], Finding] = {}
    for size in sizes:
        severe = bool(size.moves.max(initial=0.0) > SEVERE)
        doubtful = size.moves > DOUBTFUL_MOVE
        if severe:  # too large for a linear estimate of what it moves
            doubtful |= _acting(model, size.fault.nuisance.joint) & (size.half > 0.0)
        moved = [name for name, is_doubtful in zip(model.names, doubtful, strict=True) if is_doubtful]
        severity: Severity = "error" if severe else "warning"
        finding = describe_fault(size.fault.nuisance, size.delta, HALF_WIDTH * size.std, severity).affecting(moved)
        place = (finding.kind, finding.joint)
        if place in findings:  # another form of the same fault
            first = findings[place]
            findings[place] = first.affecting(tuple(dict.fromkeys((*first.parameters, *moved))))
        else:
            findings[place] = finding
    return tuple(findings.values())


def _acting(model: TorqueModel, joint: str) -> NDArray[np.bool_]:
    """Which parameters act on a joint, or on any where it has no name, (P,)."""
    at = model.acting if not joint else model.acting[[model.joint_names.index(joint)]]
    return np.asarray(at.any(axis=0))


def find_faults(checked: Checked, values: FloatArray, evidence: Evidence | None = None) -> tuple[FaultSize, ...]:
    """Look for faults that explain the residuals of a fit, the most convincing first.

    Each fault that is found is taken out of the recordings, or its columns stay in the fit, before the next is looked
    for. At the end each is estimated beside all others, and those that are no longer significant are dropped.

    Args:
        checked: Torque model and data.
        values: Fitted parameters, (P,).
        evidence: Rows of them; None to form them.

    Returns:
        Faults with their sizes; none where the recordings are too short for a check.
    """
    layout = column_layout(checked.model)
    candidates, protecting = nuisances(checked.model, layout), always(layout)
    limit = FALSE_ALARMS / len(candidates)
    faults: list[Fault] = []
    try:
        evidence = gather(checked, values) if evidence is None else evidence
        before = evidence.state(()).values
        for _ in range(STEPS):
            best = _best(evidence, candidates, faults, protecting, limit)
            if best is None:
                break
            delta = 0.0
            if is_corrected(best.nuisance):
                most = LARGEST[best.nuisance.kind]
                delta = float(np.clip(best.delta[0], -most, most))
                data = tuple(corrected(one, best.nuisance.kind, best.nuisance.place, delta) for one in checked.data)
                checked = checked._replace(data=data)
            faults = _added(faults, Fault(best.nuisance, delta))
            if is_corrected(best.nuisance):
                columns = [column for fault in faults for column in fault.columns]
                evidence = gather(checked, evidence.state(columns).values)
        sizes = (_size(evidence, fault, faults, protecting) for fault in faults)
        found = [size for size in sizes if size.p_value < limit and size.moves.max(initial=0.0) > SMALLEST_MOVE]
        if found:
            columns = [column for fault in faults for column in fault.columns]
            found[0] = found[0].moving_at_least(evidence.state(columns).values - before)
        return tuple(found)
    except (ExoidError, np.linalg.LinAlgError):
        return ()  # too little is left for a check


def _best(
    evidence: Evidence, candidates: Sequence[Nuisance], faults: Sequence[Fault], protecting: Sequence[int], limit: float
) -> Score | None:
    """Most convincing fault that is significant and moves a parameter out of its interval; None where there is none."""
    fitted = [column for fault in faults for column in fault.columns]
    taken = [fault.nuisance for fault in faults]
    state = _state_beside(evidence, taken, protecting)
    plain = evidence.state(fitted, state)
    scores = [state.test(nuisance, plain) for nuisance in candidates if nuisance not in taken]
    for fault in faults:
        if is_corrected(fault.nuisance):  # what a first step left of it
            others = [nuisance for nuisance in taken if nuisance != fault.nuisance]
            scores.append(_state_beside(evidence, others, protecting).test(fault.nuisance, plain))
    scores = [
        _again(evidence, score, (taken, fitted), protecting) if score is not None and score.gain > LARGE_GAIN else score
        for score in scores
    ]
    likely = [
        score
        for score in scores
        if score is not None and score.p_value < limit and score.largest_move > SMALLEST_MOVE and score.evidence > 0.0
    ]
    return max(likely, key=lambda score: score.evidence, default=None)


def _again(
    evidence: Evidence, score: Score, beside: tuple[Sequence[Nuisance], Sequence[int]], protecting: Sequence[int]
) -> Score | None:
    """Test a fault with the noise of residuals that no longer contain it, which it would make look coloured."""
    taken, fitted = beside
    others = [nuisance for nuisance in taken if nuisance != score.nuisance]
    full = _state_beside(evidence, (*others, score.nuisance), protecting)
    columns = (*(column for nuisance in others for column in nuisance.columns), *protecting)
    return evidence.state(tuple(dict.fromkeys(columns)), full).test(score.nuisance, evidence.state(fitted, full))


def _state_beside(evidence: Evidence, taken: Sequence[Nuisance], protecting: Sequence[int]) -> State:
    """Fit with the columns of some faults, those that are taken out of the recordings too."""
    columns = (*(column for nuisance in taken for column in nuisance.columns), *protecting)
    return evidence.state(tuple(dict.fromkeys(columns)))


def _added(faults: Sequence[Fault], new: Fault) -> list[Fault]:
    """Add a fault; one that was found before grows."""
    before = sum(fault.applied for fault in faults if fault.nuisance == new.nuisance)
    others = [fault for fault in faults if fault.nuisance != new.nuisance]
    return [*others, new._replace(applied=before + new.applied)]


def _size(evidence: Evidence, fault: Fault, faults: Sequence[Fault], protecting: Sequence[int]) -> FaultSize:
    """Estimate one fault beside all others."""
    others = [other.nuisance for other in faults if other.nuisance != fault.nuisance]
    fitted = [c for other in faults if other.nuisance != fault.nuisance for c in other.columns]
    full = _state_beside(evidence, (*others, fault.nuisance), protecting)
    columns = (*(column for nuisance in others for column in nuisance.columns), *protecting)
    state = evidence.state(tuple(dict.fromkeys(columns)), full)
    plain = evidence.state(tuple(dict.fromkeys(fitted)), full)
    score = state.test(fault.nuisance, plain)
    if score is None:  # others explain it now
        nothing = np.zeros(evidence.count)
        return FaultSize(fault, np.zeros(1), np.zeros(1), 1.0, nothing, nothing)
    if not is_corrected(fault.nuisance):
        return FaultSize(fault, score.delta, score.std, score.p_value, score.move, score.half)
    total = fault.applied + float(score.delta[0])
    std = float(score.std[0])
    slope = plain.slope(fault.nuisance)
    return FaultSize(
        fault, np.array([total]), score.std, score.p_of(total / max(std, 1e-300)), -slope * total, score.half
    )


class Delays(NamedTuple):
    """Delays of the torques of all joints.

    Attributes:
        values: Delays, 0 where none is significant [s], (n,).
        half: Half widths of their 95 % intervals [s], (n,).
    """

    values: FloatArray
    half: FloatArray


def delays(sizes: Sequence[FaultSize], joints: int) -> Delays:
    """Add up the delays of the torque of each joint.

    Args:
        sizes: Faults that were found.
        joints: Number of joints, n.

    Returns:
        Delay of the torque of each joint.
    """
    total, variance = np.zeros((2, joints))
    for size in sizes:
        if size.fault.nuisance.kind == "torque-delay":
            joint = slice(None) if size.fault.nuisance.place < 0 else size.fault.nuisance.place
            total[joint] += size.delta[0]
            variance[joint] += size.std[0] ** 2
    return Delays(total, HALF_WIDTH * np.sqrt(variance))
