"""Checks of a fit against faults that nuisance columns describe, chosen one after the other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .corrections import corrected
from .evidence import Evidence
from .faults import SMALLEST_MOVE, Fault, FaultSize, is_corrected
from .nuisance_columns import FORCES, column_layout
from .nuisances import Nuisance, always, nuisances
from .sample import Checked, gather
from .score import HALF_WIDTH, LARGE_GAIN, Score, State

FALSE_ALARMS = 0.005
"""Probability with which some fault would be found in a log without any."""

CLEARLY = 1.5
"""Faults whose evidence is so many times smaller than that of the best are not tested again."""

UNDECIDED = 3.0
"""Faults whose evidence is less than this below that of the best (20 times less likely) are named beside it."""

STEPS = 6
"""Faults that are looked for at most."""

LARGEST = {"torque-delay": 0.1, "torque-scale": 2.0, "angle-offset": 0.5, "angle-scale": 0.5, "gravity-direction": 0.5}
"""Largest part of a fault that is taken out at once: beyond, one step of Gauss and Newton is not to be trusted."""


def find_faults(checked: Checked, values: FloatArray, evidence: Evidence | None = None) -> tuple[FaultSize, ...]:
    """Look for faults that explain the residuals of a fit, the most convincing first."""
    # Each fault that is found is taken out of the recordings, or its columns stay in the fit, before the next is looked
    # for. At the end each is estimated beside all others, and those that are no longer significant are dropped.
    layout = column_layout(checked.model, checked.arms)
    candidates, protecting = nuisances(checked.model, layout, checked.arms), always(layout)
    limit = FALSE_ALARMS / len(candidates)
    faults: list[Fault] = []
    try:
        evidence = gather(checked, values) if evidence is None else evidence
        before = State.of(evidence, ()).values
        for _ in range(STEPS):
            likely = _likely(evidence, candidates, faults, protecting, limit)
            if not likely:
                break
            best, *alternatives = likely
            delta = 0.0
            if is_corrected(best.nuisance):
                most = LARGEST[best.nuisance.kind]
                delta = float(np.clip(best.delta[0], -most, most))
                data = tuple(corrected(one, best.nuisance.kind, best.nuisance.place, delta) for one in checked.data)
                checked = checked._replace(data=data)
            faults = _added(faults, Fault(best.nuisance, delta, tuple(alternatives)))
            if is_corrected(best.nuisance):
                columns = [column for fault in faults for column in fault.columns]
                evidence = gather(checked, State.of(evidence, columns).values)
        forms = [k for k, column in enumerate(layout) if column.kind in FORCES]
        sizes = (
            _size(evidence, fault, faults, protecting, forms if fault.nuisance.kind == "unmodelled-force" else ())
            for fault in faults
        )
        found = [size for size in sizes if size.p_value < limit and size.matters]
        if found:
            columns = [column for fault in faults for column in fault.columns]
            found[0] = found[0].moving_at_least(State.of(evidence, columns).values - before)
        return tuple(found)
    except (ExoidError, np.linalg.LinAlgError):
        return ()  # too little is left for a check


def _likely(
    evidence: Evidence, candidates: Sequence[Nuisance], faults: Sequence[Fault], protecting: Sequence[int], limit: float
) -> list[Score]:
    """Most convincing fault that is significant and moves a parameter out of its interval, and those as likely."""
    fitted = [column for fault in faults for column in fault.columns]
    taken = [fault.nuisance for fault in faults]
    state = _state_beside(evidence, taken, protecting)
    plain = State.of(evidence, fitted, state)
    new = [nuisance for nuisance in candidates if nuisance not in taken]
    scores = [state.test(nuisance, plain, limit) for nuisance in state.conspicuous(new)]
    for fault in faults:
        if is_corrected(fault.nuisance):  # what a first step left of it
            others = [nuisance for nuisance in taken if nuisance != fault.nuisance]
            beside = _state_beside(evidence, others, protecting, fault.nuisance)
            scores.append(beside.test(fault.nuisance, plain, limit))
    likely: list[Score] = []
    for score in sorted((one for one in scores if one is not None), key=lambda one: -one.evidence):
        most = max((one.evidence for one in likely), default=-np.inf)
        if most > max(CLEARLY * score.evidence, score.evidence + UNDECIDED):
            break
        again = _again(evidence, score, (taken, fitted), protecting, state) if score.gain > LARGE_GAIN else score
        if again is None or again.p_value >= limit or again.largest_move <= SMALLEST_MOVE or again.evidence <= 0.0:
            continue
        likely.append(again)
    likely.sort(key=lambda one: -one.evidence)
    return [one for one in likely if one.evidence > likely[0].evidence - UNDECIDED]


def _again(
    evidence: Evidence,
    score: Score,
    beside: tuple[Sequence[Nuisance], Sequence[int]],
    protecting: Sequence[int],
    before: State,
) -> Score | None:
    """Test a fault with the noise of residuals that no longer contain it, which it would make look coloured."""
    taken, fitted = beside
    others = [nuisance for nuisance in taken if nuisance != score.nuisance]
    full = _state_beside(evidence, (*others, score.nuisance), protecting, score.nuisance, before)
    columns = (*(column for nuisance in others for column in nuisance.columns), *protecting)
    return State.of(evidence, tuple(dict.fromkeys(columns)), full).test(
        score.nuisance, State.of(evidence, fitted, full)
    )


def _state_beside(
    evidence: Evidence,
    taken: Sequence[Nuisance],
    protecting: Sequence[int],
    tested: Nuisance | None = None,
    near: State | None = None,
) -> State:
    """Fit with the columns of some faults, those that are taken out of the recordings too, to test one or any other."""
    columns = (*(column for nuisance in taken for column in nuisance.columns), *protecting)
    return State.of(
        evidence, tuple(dict.fromkeys(columns)), tested=None if tested is None else tested.columns, near=near
    )


def _added(faults: Sequence[Fault], new: Fault) -> list[Fault]:
    """Add a fault; one that was found before grows."""
    others = [fault for fault in faults if fault.nuisance != new.nuisance]
    for fault in faults:
        if fault.nuisance == new.nuisance:
            new = fault._replace(applied=fault.applied + new.applied)
    return [*others, new]


def _size(
    evidence: Evidence, fault: Fault, faults: Sequence[Fault], protecting: Sequence[int], forms: Sequence[int]
) -> FaultSize:
    """Estimate one fault beside all others; its torque may consist of other columns (forms) than were tested."""
    others = [other.nuisance for other in faults if other.nuisance != fault.nuisance]
    fitted = [c for other in faults if other.nuisance != fault.nuisance for c in other.columns]
    full = _state_beside(evidence, (*others, fault.nuisance), protecting, fault.nuisance)
    columns = (*(column for nuisance in others for column in nuisance.columns), *protecting)
    state = State.of(evidence, tuple(dict.fromkeys(columns)), full)
    plain = State.of(evidence, tuple(dict.fromkeys(fitted)), full)
    score = state.test(fault.nuisance, plain)
    if score is None:  # others explain it now
        nothing = np.zeros(evidence.count)
        return FaultSize(fault, np.zeros(1), np.zeros(1), 1.0, nothing, nothing, nothing)
    reach, parameters = np.zeros(evidence.count), np.arange(evidence.count)
    if not is_corrected(fault.nuisance):
        if forms:
            reach = plain.reach(fault.nuisance.columns, score.delta, forms)
        torque = evidence.torque_share(fault.nuisance, score.delta)
        share = float(evidence.torque_shares(parameters, score.move).max())
        return FaultSize(fault, score.delta, score.std, score.p_value, score.move, score.half, reach, torque, share)
    total = fault.applied + float(score.delta[0])
    p_value, move = score.p_of(total / max(float(score.std[0]), 1e-300)), -plain.slope(fault.nuisance) * total
    torque = evidence.torque_share(fault.nuisance, np.array([total]))
    share = float(evidence.torque_shares(parameters, move).max())
    return FaultSize(fault, np.array([total]), score.std, p_value, move, score.half, reach, torque, share)


class Delays(NamedTuple):
    """Delays of the torques of all joints."""

    values: FloatArray  # delays, 0 where none is significant [s], (n,)
    half: FloatArray  # half widths of their 95 % intervals [s], (n,)


def delays(sizes: Sequence[FaultSize], joints: int) -> Delays:
    """Add up the delays of the torque of each joint."""
    total, variance = np.zeros((2, joints))
    for size in sizes:
        if size.fault.nuisance.kind == "torque-delay":
            joint = slice(None) if size.fault.nuisance.place < 0 else size.fault.nuisance.place
            total[joint] += size.delta[0]
            variance[joint] += size.std[0] ** 2
    return Delays(total, HALF_WIDTH * np.sqrt(variance))
