"""Faults that explain the residuals of a fit, found one after the other, and the findings that say so."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import reduce
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate.finding import Finding, Severity
from exoid.regression.least_squares import TINY, scaled_inverse
from exoid.signals import Poses, Recording, without_torque_delay
from exoid.signals.cutoff import noisier

from .changes import BLOCKS, Change, described, find_changes, with_change
from .evidence import Evidence, torque_shares
from .kinds import KINDS, Library, Nuisance
from .sample import FittedLeg, gather
from .score import HALF_WIDTH, LARGE_GAIN, WORTH_A_LOOK, Score, State, in_half_widths, p_value_of

SMALLEST_MOVE, DOUBTFUL_MOVE, FAR_MOVE, UNDECIDED = 0.5, 0.25, 10.0, 3.0
"""Half widths by which a fault moves a parameter if it matters, makes it doubtful, or is an error; and evidence below
that of the best (20 times less likely) from which on others are not named beside it."""

STUCK = 0.03  # speed below which a joint may stick, as in the default terms [rad/s]
LATE = 0.01  # delay of torques as a mistake of recording makes it, at least [s]
SCALES = ("torque-scale", "angle-scale")
FORWARD = ("elastic-joint", "play", "angle-delay", "smoothed-torque")  # no link is ahead of its load, nor angle early


class Fault(NamedTuple):
    """Size of a fault beside all others, and what it does to the parameters."""

    score: Score  # test, with its size and what it moves
    alternatives: tuple[Score, ...]  # faults that explain the log about as well
    reach: FloatArray  # largest change of the parameters by a fault of this kind, torque and any form, (P,)
    change: float  # RMS change of the predicted torque of a joint by the parameters that move, over its RMS torque
    hints: FloatArray  # see `exoid.identification.findings.columns.residual_hints`, (n, 3)

    @property
    def moves_far(self) -> bool:
        """Whether the fault moves a parameter by many half widths."""
        return bool(self.score.moves.max(initial=0.0) > FAR_MOVE)


def find_faults(fitted: FittedLeg, evidence: Evidence | None = None) -> tuple[tuple[Fault, ...], FloatArray]:
    """Look for faults that explain residuals, the most convincing first; and the RMS residuals beside them, (n,)."""
    # Each fault that is found is taken out of the recordings, or its columns stay in the fit, before the next is looked
    # for. At the end each is estimated beside all others, and those that are no longer significant are dropped.
    library, candidates = fitted.library, fitted.library.faults
    limit = 0.005 / len(candidates)  # some fault would be found in 0.5 % of the logs without any
    try:
        evidence = gather(fitted) if evidence is None else evidence
        beside = _Beside(evidence, {}, library)
        changes: list[Change] = []
        for _ in range(6):  # at most so many faults
            state = beside.fit()
            friction = (*beside.staying(), *library.always, *library.friction)
            beside_friction = State.of(beside.evidence, friction, near=state)
            for change in find_changes(beside_friction, fitted.model, library.columns):
                if change not in changes:
                    changes.append(change)
                    beside = beside._replace(evidence=with_change(beside.evidence, change))
                    candidates = (*candidates, described(change, beside.evidence, fitted.model, library.columns))
                    state = beside.fit(near=state)
            likely = _likely(beside, state, candidates, limit)
            if not likely:
                break
            best, delta = likely[0].nuisance, 0.0
            if best.kind == "elastic-joint" and not _is_spring(likely[0], beside, fitted, changes):
                candidates = tuple(one for one in candidates if one.kind != "elastic-joint")  # noise imitates them here
                continue
            if best.is_corrected:
                most = KINDS[best.kind].most
                delta = float(np.clip(likely[0].delta[0], -most, most))
                # a fit that has taken part of a scale into its parameters asks for too small a factor, or too large
                delta = float(np.expm1(delta)) if best.kind == "torque-scale" else delta
                data = tuple(_corrected(one, best, delta, fitted.clock_start(one)) for one in fitted.data)
                fitted = fitted._replace(data=data)
            applied, others = beside.faults.pop(best, (0.0, tuple(likely[1:])))  # one that was found before grows
            beside.faults[best] = _together(best, applied, delta), others
            if best.is_corrected:
                again = gather(fitted._replace(values=State.of(beside.evidence, beside.staying()).values))
                beside = beside._replace(evidence=reduce(with_change, changes, again))
        full = beside.fit() if beside.faults or changes else state
        sizes = (_sized(beside, full, fault) for fault in beside.faults)
        found = [fault for fault in sizes if fault is not None and _counts(fault.score, limit)]
        if found:  # the first is blamed for what all together move more than it does alone
            now, before = State.of(beside.evidence, beside.staying()), State.of(evidence, library.free)
            total, first = now.values - before.values, found[0].score
            move = np.where(np.abs(total) > np.abs(first.move), total, first.move)
            found[0] = found[0]._replace(score=first._replace(move=move))
        return tuple(found), 1.0 / full.weights
    except (ExoidError, np.linalg.LinAlgError):
        return (), np.full(len(fitted.model.leg.joint_names), np.inf)  # too little is left for a check


class _Beside(NamedTuple):
    """Faults that were found so far, beside which others are tested."""

    evidence: Evidence  # the rows, without the faults that were taken out
    # faults in the order in which they were found: the part that was taken out, and those that explain as much
    faults: dict[Nuisance, tuple[float, tuple[Score, ...]]]
    library: Library  # nuisance columns

    def staying(self, without: Nuisance | None = None) -> list[int]:
        """Columns of the faults that stay in the fit, and of scales."""
        stay = (one for one in self.faults if not one.is_corrected and one != without)
        return [*self.library.free, *(column for one in stay for column in one.columns)]

    def fit(self, tested: Nuisance | None = None, *, also: tuple[Nuisance, ...] = (), **how: State | None) -> State:
        """Fit with the columns of all faults but the tested one, those that are taken out of the recordings too."""
        others = (*(one for one in self.faults if one != tested), *also)
        columns = (*(column for one in others for column in one.columns), *self.library.free, *self.library.always)
        columns = tuple(dict.fromkeys((*columns, *(tested.beside if tested else ()))))
        return State.of(self.evidence, columns, **how)

    def test(self, fault: Nuisance, full: State) -> tuple[Score | None, State]:
        """Test a fault with the noise that a fit with it leaves: with the fault, residuals would look coloured."""
        plain = State.of(self.evidence, self.staying(without=fault), like=full)
        return self.fit(fault, like=full).test(fault, plain), plain


def _together(fault: Nuisance, applied: float, delta: float) -> float:
    """Size of a fault of which a part was taken out before: scales multiply."""
    return (1.0 + applied) * (1.0 + delta) - 1.0 if fault.kind in SCALES else applied + delta


def _is_late(score: Score) -> bool:
    """Whether a fault is a torque that is late by far, as a mistake of recording makes it."""
    return score.nuisance.kind == "torque-delay" and float(score.delta[0]) > LATE


def _is_scaled(score: Score) -> bool:
    """Whether a fault is a torque or an angle out of scale that explains much."""
    return score.nuisance.kind in SCALES and score.gain > LARGE_GAIN


def _counts(score: Score, limit: float) -> bool:
    """Whether a fault is significant and moves a parameter."""
    # Late torques are common: their limit of significance is ten times larger, and their least move half. Each names
    # one to three more of 40 machines of the proving ground, seeds below 60.
    least = {**dict.fromkeys(FORWARD, 0.0), "saturation": 0.75, "torque-curve": -score.nuisance.most}
    if score.nuisance.kind in least and not least[score.nuisance.kind] <= score.delta[0] <= score.nuisance.most:
        return False
    # a change is the best of those at all times, and limits and waves are those of many
    best = score.nuisance.kind in ("change", "wrong-load", "saturation", "angle-ripple")
    ease = 10.0 if _is_late(score) else 1.0 / BLOCKS if best else 1.0
    moves = 0.5 * SMALLEST_MOVE if _is_late(score) else SMALLEST_MOVE
    return score.p_value < ease * limit and bool(score.moves.max(initial=0.0) > moves)


def _is_spring(score: Score, beside: _Beside, fitted: FittedLeg, changes: Sequence[Change]) -> bool:
    """Whether a spring stays beside more noise of the angles, whose torque is not in the measured one either."""
    # Of springs on the proving ground, seeds 0 to 43, 14 of 15 keep over 0.8 of their compliance beside the noise once
    # more; what noise imitates keeps less than 0.5.
    rng = np.random.default_rng(0)
    for _ in range(2):
        data = tuple(one if isinstance(one, Poses) else replace(one, q=noisier(one.q, rng)) for one in fitted.data)
        noisy = beside._replace(evidence=reduce(with_change, changes, gather(fitted._replace(data=data))))
        again = noisy.test(score.nuisance, noisy.fit())[0]
        if again is None or again.delta[0] < 0.5 * score.delta[0]:
            return False
    return True


def _likely(beside: _Beside, state: State, candidates: Sequence[Nuisance], limit: float) -> list[Score]:
    """Most convincing fault that is significant and moves a parameter out of its interval, and those as likely."""
    plain = State.of(beside.evidence, beside.staying(), like=state)
    # columns of a force only resemble a strap: what they leave looks like waves of the angle
    pulled = {("angle-ripple", one.joint) for one in beside.faults if one.kind == "unmodelled-force"}
    new = [one for one in candidates if one not in beside.faults and (one.kind, one.joint) not in pulled]
    tested = ((one, WORTH_A_LOOK if one.kind == "torque-delay" else limit) for one in new)
    scores = [state.test(one, plain, most) for one, most in tested]
    # what a first step left of faults that were taken out
    scores += [beside.fit(fault).test(fault, plain, limit) for fault in beside.faults if fault.is_corrected]
    shift = (one for one in scores if one and one.nuisance.kind == "torque-delay" and not one.nuisance.joint)
    constant = max((one.evidence for one in shift if not _is_late(one)), default=-np.inf)
    likely: list[Score] = []
    for score in sorted((one for one in scores if one is not None), key=lambda one: -round(one.evidence, 6)):
        most = max((one.evidence for one in likely), default=-np.inf)
        if score.nuisance.kind == "two-clocks" and constant > 0.8 * score.evidence:
            continue  # a motion that becomes faster shows a short delay ever more
        if most > max(1.5 * score.evidence, score.evidence + UNDECIDED) and not (_is_late(score) or _is_scaled(score)):
            continue  # a second test with other noise would not bring it to the best
        fault, once_more = score.nuisance, score.gain > LARGE_GAIN or bool(score.nuisance.beside)
        again = beside.test(fault, beside.fit(fault, also=(fault,), near=state))[0] if once_more else score
        if again is not None and _counts(again, limit) and again.evidence > 0.0:
            likely.append(again)
    # straps and cross-talk of many columns imitate a late torque, or one out of scale, which one number explains
    most = max((one.evidence for one in likely), default=0.0)
    plainly = any(_is_late(one) or (_is_scaled(one) and 1.5 * one.evidence > most) for one in likely)
    last = ("unmodelled-force", "cross-talk") * plainly
    # of a torque of one sign, curve and scale are one column: the scale goes first, not what rounding prefers
    likely.sort(key=lambda x: (x.nuisance.kind in last, -round(x.evidence, 6), x.nuisance.kind == "torque-curve"))
    if likely and float(np.linalg.norm(likely[0].delta)) > likely[0].nuisance.most:
        return []  # something else is wrong, of which the columns know nothing
    # a load has more numbers than a zero: it stands beside one that explains no more
    spare = [UNDECIDED + (len(one.delta) - 1) * np.log(one.dof) * (one.nuisance.kind == "wrong-load") for one in likely]
    return [one for one, most in zip(likely, spare, strict=True) if abs(one.evidence - likely[0].evidence) < most]


def _sized(beside: _Beside, full: State, fault: Nuisance) -> Fault | None:
    """Estimate one fault beside all others; None where they explain it now, or it is too small, or predicts nothing."""
    score, plain = beside.test(fault, full)
    if score is None:
        return None
    evidence, count, (applied, alternatives) = beside.evidence, len(beside.evidence.fixed), beside.faults[fault]
    reach = np.zeros(count)
    if fault.kind == "unmodelled-force":  # its torque may have other forms than the columns tested
        forms = [k for k, column in enumerate(beside.library.columns) if column.kind in ("force", "force²")]
        reach = plain.reach(fault.columns, score.delta, forms)
    if fault.is_corrected:
        total = np.array([_together(fault, applied, float(score.delta[0]))])
        std = score.std * (1.0 + applied) if fault.kind in SCALES else score.std
        p_value = p_value_of(total / np.maximum(std, 1e-300), np.eye(1), score.dof)
        score = score._replace(delta=total, std=std, p_value=p_value, move=-plain.moved(fault.columns, total))
    torque = torque_shares(evidence.factors, count + np.array(fault.columns), score.delta[:, None])
    if not (fault.is_large_enough(score.delta, float(torque[0])) and _predicts(beside, score, plain)):
        return None
    change = torque_shares(evidence.factors, np.arange(count), score.move[:, None])
    alternatives = tuple(one for one in alternatives if one.nuisance.is_large_enough(one.delta, float(torque[0])))
    return Fault(score, alternatives, reach, float(change[0]), evidence.hints)


def _predicts(beside: _Beside, score: Score, plain: State) -> bool:
    """Whether a fault predicts rows left out better, by a margin where friction of other forms does."""
    evidence, count, library, fault = beside.evidence, len(beside.evidence.fixed), beside.library, score.nuisance
    applied = float(score.delta[0]) if fault.is_corrected else 0.0
    own = count + np.array(fault.columns)
    free = np.append(evidence.free, count + np.array(library.free, dtype=np.intp))
    friction = np.append(free, count + np.array((*library.always, *fault.beside, *library.friction)))
    bare = plain.columns if fault.kind == "unmodelled-friction" else np.union1d(plain.columns, friction)
    # Friction that was found counts no more, but beside a delay: what is left of it at reversals looks like one
    found = free if fault.kind in ("torque-delay", "two-clocks") else plain.columns
    models = bare, np.append(bare, own), found, np.union1d(found, friction)
    used = np.append(np.unique(np.concatenate(models)), -1)
    blocks = np.zeros((4, len(evidence.factors), len(used), len(used)))
    for j, (weight, tables) in enumerate(zip(plain.weights, evidence.tables, strict=True)):
        for part, table in zip(evidence.parts, tables, strict=True):
            # What a joint that sticks holds is any torque up to its friction, another at each place: as of a strap
            speed = np.abs(part.v[:, j])
            moves = (speed > STUCK) | (fault.kind != "unmodelled-force") | (not speed.any())  # rows of a base have none
            for k, x in enumerate(np.array_split(weight * table[used] * moves, 16, axis=1)):
                blocks[k % 4, j] += x @ x.T
    torque = np.where(np.isin(used, own), applied, 0.0)  # as it was logged
    torque[-1] = 1.0
    errors, whole = np.zeros((4, len(evidence.factors))), blocks.sum(axis=0)
    # Columns of a force only resemble a strap, and peaks are few: of what was left out the rest says nothing
    local = fault.kind in ("unmodelled-force", "saturation")
    tests = [(whole, whole)] if local else [(whole - out, out) for out in blocks]
    for rest, out in tests:
        fitted = rest.sum(axis=0)
        for k, columns in enumerate(models):
            at, left = np.searchsorted(used[:-1], columns), torque.copy()
            left[at] -= scaled_inverse(fitted[np.ix_(at, at)]) @ (fitted[at] @ torque)
            errors[k] += np.einsum("i,jik,k->j", left, out, left)
    # Gains of log likelihood per row, of all joints. Residuals of wrong friction look a little like any fault.
    errors = np.maximum(errors, 1e-12 * blocks[..., -1, -1].sum(axis=0) + TINY)  # smaller ones are rounding
    gain, of_friction = np.log(errors[::2] / errors[1::2]).sum(axis=1).tolist()
    eased = fault.kind == "unmodelled-friction" or (fault.kind == "torque-delay" and applied > LATE)
    eased |= fault[:2] == ("change", "") and bool(library.free)  # a small one moves free constants of drives far
    least = 0.0 if eased else float(np.clip(0.36 * of_friction, 0.0, 0.9))
    return bool(gain > least)


def _corrected(data: Recording | Poses, fault: Nuisance, delta: float, start: float) -> Recording | Poses:
    """Take a fault out of a recording; gravity in another direction in a planar leg only."""
    joints = list(range(len(data.joint_names)) if fault.place < 0 else (fault.place,))
    if fault.kind in ("torque-delay", "two-clocks"):
        if isinstance(data, Poses):
            return data
        late = delta if fault.kind == "torque-delay" else delta * (data.time - start)
        return without_torque_delay(data, dict.fromkeys(joints, late))
    names: tuple[str, ...] = "q", "v", "a"
    factor, offset = 1.0 + delta, 0.0
    if fault.kind == "torque-scale":
        names, factor = ("tau",), 1.0 / (1.0 + delta)
    elif fault.kind != "angle-scale":
        names, factor, offset = ("q",), 1.0, delta
    own = np.isin(range(len(data.joint_names)), joints)
    signals = {name: x for name in names if (x := getattr(data, name, None)) is not None}
    return replace(data, **{name: np.where(own, factor * x + offset, x) for name, x in signals.items()})


def findings_of(fitted: FittedLeg, faults: Sequence[Fault]) -> tuple[Finding, ...]:
    """Describe faults that were found."""
    findings: dict[tuple[str, str], Finding] = {}
    for one in (each for fault in faults for each in _described(fitted, fault)):
        first = findings.setdefault((one.kind, one.joint), one)
        if first is not one:  # another form of the same fault
            names = tuple(dict.fromkeys((*first.parameters, *one.parameters)))
            findings[one.kind, one.joint] = replace(first, parameters=names)
    return tuple(findings.values())


def _described(fitted: FittedLeg, fault: Fault) -> Iterator[Finding]:
    """A finding, and one for each other fault that explains the log about as well."""
    score, joint, model = fault.score, fault.score.nuisance.joint, fitted.model
    bodies, all_names = len(model.leg.parameter_names), np.array(model.names)
    doubtful = np.maximum(score.moves, in_half_widths(fault.reach, score.half)) > DOUBTFUL_MOVE
    if fault.moves_far:  # too large for a linear estimate of what it moves
        acting = model.acting if not joint else model.acting[[model.leg.joint_names.index(joint)]]
        doubtful |= acting.any(axis=0) & (score.half > 0.0)
    # An error has to be certain, and worth stopping for: a parameter moves far, and a joint's predicted torque by 5 %.
    # 30 of 32 springs are less probable in noise than 1e-8; other friction is more.
    drifts = score.nuisance.unit.endswith("/s")  # and is right on average
    certain = fault.change > 0.05 and score.p_value < 1e-8 and not drifts
    severity: Severity = "error" if fault.moves_far and certain else "warning"
    effect = f"; it changes the predicted torque of a joint by {fault.change:.2g} of its RMS value"
    rivals = (one for one in fault.alternatives if one.nuisance[:2] != score.nuisance[:2])  # kind and joint
    both = [(score, doubtful), *((one, one.moves > DOUBTFUL_MOVE) for one in rivals)]
    whole = {*(() if model.leg.closure is None else model.leg.tree_joint_names)}
    closed = bool(whole) and any(not whole <= {*one.joint_names} for one in fitted.data)
    names_of = [" at ".join(filter(None, (one.nuisance.kind, one.nuisance.joint))) for one, _ in both]
    for k, (one, is_doubtful) in enumerate(both):
        what, half, interval = one.nuisance, HALF_WIDTH * one.std, None
        size = one.delta[1:4] if what.kind == "wrong-load" else one.delta  # of a load its mass moment
        kind, value = KINDS[what.kind], float(np.linalg.norm(size))
        if len(one.delta) == 1:
            value, *ends = (kind.value(float(one.delta[0]) + error) for error in (0.0, -float(half[0]), float(half[0])))
            interval = (min(ends), max(ends))
        loops = ["a wrong place in a loop, which angles of its dependent joints would tell,"]
        loops *= closed and what.kind in ("angle-offset", "angle-scale", "clock", "segment-length", "gravity-direction")
        others = " or ".join((*names_of[:k], *names_of[k + 1 :], *loops))
        more = f"; {others} would explain this log about as well" if others else ""
        text = kind.message(what, value, one.delta, *fault.hints[what.place].tolist())
        message = f"{text}{more}{effect if severity == 'error' else ''}"
        names = tuple(all_names[is_doubtful].tolist())
        for constant, j in fitted.constants.items():  # a body that is off goes with the torque that moves it
            of_body = model.own_parameters(j) or all_names[:bodies][model.acting[j, :bodies]].tolist()
            names += () if set(names).isdisjoint(of_body) else (constant,)
        yield Finding(what.kind, what.joint, value, what.unit, severity, message, kind.remedy, interval, names)
