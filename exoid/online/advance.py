"""One step of the recursive estimator: a pure function from a state and a block of samples to the next state."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray

from .changes import SPANNED, Detection, Verdict, judge, look
from .drift import drift_limit, follow_epochs
from .information import absorb
from .rows import Block, Rows, rows_of
from .settings import Settings
from .solution import belief, current, follow_residuals, inflations, inverse_of
from .state import REMEMBERED, Change, Detector, Information, State, begin, checkpoints_of, no_epochs

SETTLED = 20.0
"""Rows for each parameter from which on innovations are noise, not errors of the first values."""

DECISION = 1.5
"""Time over the window from a suspicion to the first name of what changed."""

PROBATION = 20.0
"""Time over the window for which rows are collected after a suspicion: a wrong name is found out, and taken back."""


class Recursion(NamedTuple):
    """What a step needs beside state and samples."""

    settings: Settings
    detection: Detection  # hypotheses of the change detection with their thresholds
    drift_limit: float  # threshold of slow changes

    @classmethod
    def of(cls, settings: Settings) -> Recursion:
        """Prepare the recursion."""
        return cls(settings, Detection.of(settings), drift_limit(settings))

    def begin(self) -> State:
        """Make the state before the first sample, which knows nothing."""
        return begin(self.settings, len(self.detection.hypotheses))


def advance(recursion: Recursion, state: State, block: Block) -> State:
    """Take a block of samples in: as many as ``settings.block``; without a filter, any number."""
    settings, detection = recursion.settings, recursion.detection
    rows, state = rows_of(settings, state, block)
    state = state._replace(samples=state.samples + len(block.q))
    if not rows.used.any():
        return _with_residuals(settings, state, rows)
    if state.detector.crossing >= 0:
        return _suspect(recursion, state, rows)
    known = np.isfinite(state.std[0]) and state.information.rows.sum() > SETTLED * settings.count
    if known and detection.on:
        inflation, innovations = inflations(settings, state.correlation), rows.tau - rows.W @ state.values
        root = _root(settings, state, state.information)
        detector = look(settings, detection, state.detector, rows, innovations, state.weights, inflation, root)
        state = state._replace(detector=detector, sharpest=np.maximum(state.sharpest, detector.weights))
    if state.detector.crossing >= 0:
        return _begin_suspicion(settings, state)
    state = _solved(settings, state, absorb(settings, state.information, rows, state.weights))
    state = _with_residuals(settings, state, rows)
    if known and np.isfinite(recursion.drift_limit):
        state = follow_epochs(settings, recursion.drift_limit, state, rows)
    if state.detector.settled % max(1, round(settings.window / settings.block_time)):
        return state
    pairs = zip(state.information, state.checkpoints, strict=True)
    return state._replace(checkpoints=Information(*(np.concatenate([now[None], old[:-1]]) for now, old in pairs)))


def _solved(settings: Settings, state: State, information: Information) -> State:
    """Solve for values, standard deviations and weights, as soon as they are determined."""
    state = state._replace(information=information)
    found = current(settings, information, state.weights, inflations(settings, state.correlation))
    return state if found is None else state._replace(**found._asdict())


def _with_residuals(settings: Settings, state: State, rows: Rows) -> State:
    """Add the residuals to their autocorrelation, once values are known, and not beside a suspicion."""
    if state.detector.crossing >= 0:
        return state
    used = rows.used & np.isfinite(state.std[0])
    residuals = (rows.tau - rows.W @ state.values) * used
    return state._replace(correlation=follow_residuals(settings, state.correlation, residuals, used))


def _begin_suspicion(settings: Settings, state: State) -> State:
    """Hold the estimate; the oldest checkpoint is what was known before the change."""
    before = current(settings, _oldest(state), state.detector.weights, inflations(settings, state.correlation))
    values = state.values if before is None else before.values
    return state._replace(detector=_emptied(state.detector)._replace(values=values, named=-1, candidates=()))


def _suspect(recursion: Recursion, state: State, rows: Rows) -> State:
    """Collect rows, and go on from before the change without what the candidates may have changed."""
    settings, detector = recursion.settings, state.detector._replace(crossing=state.detector.crossing + 1)
    blocks = detector.crossing
    if blocks * settings.block_time > 2.0 * settings.delay:  # rows behind the filters are of one leg alone
        detector = detector._replace(collected=_stacked(detector.collected, rows))
    state = state._replace(detector=detector)
    if blocks * settings.block_time <= DECISION * settings.window + settings.delay:
        return state
    root = _root(settings, state._replace(weights=detector.weights), _oldest(state))
    verdict = judge(recursion.detection, detector, inflations(settings, state.correlation), root)
    if verdict.torn:  # a second change, or none: everything may have changed, and rows from now on say what
        state = _given_up(settings, state, np.eye(settings.count), collected=False)
        every = tuple(range(len(recursion.detection.hypotheses)))
        return state._replace(detector=_emptied(detector)._replace(crossing=0, named=-1, candidates=every))
    if verdict.best < 0:  # whatever it was, it is over: the change is taken back
        held = state.information if not detector.candidates else _oldest(state)
        changes = state.changes[: len(state.changes) - (detector.named >= 0)]
        kept = Information(*(x.copy() for x in held))
        kept = _stacked_factors(kept, detector.collected)
        state = _solved(settings, state._replace(changes=changes, weights=detector.weights), kept)
        return _settle(settings, state)
    bases = [recursion.detection.hypotheses[k].basis for k in verdict.candidates]
    basis = _union(bases) if verdict.complete else np.eye(settings.count)
    state = _given_up(settings, state, basis)
    over = blocks * settings.block_time > PROBATION * settings.window
    if len(verdict.candidates) == 1 or over:
        state = _named(recursion, state, verdict)
    state = state._replace(detector=state.detector._replace(candidates=verdict.candidates))
    return _settle(settings, state) if over else state


def _named(recursion: Recursion, state: State, verdict: Verdict) -> State:
    """Report a change, in place of another name that was reported for the same rows."""
    detector = state.detector
    if verdict.best == detector.named:
        return state
    one = recursion.detection.hypotheses[verdict.best]
    change = Change(
        sample=state.samples,
        time=state.samples / recursion.settings.rate,
        kind=one.kind,
        joint=one.joint,
        parameters=one.parameters,
        statistic=float(verdict.ratios[verdict.best]),
        values=tuple(detector.values.tolist()),
    )
    earlier = state.changes[: len(state.changes) - (detector.named >= 0)]
    return state._replace(
        detector=detector._replace(named=verdict.best),
        changes=(*earlier, change)[-REMEMBERED:],
        epochs=no_epochs(recursion.settings),
    )


def _settle(settings: Settings, state: State) -> State:
    """End a suspicion; the mean of the statistics stays that of this motion."""
    detector = _emptied(state.detector)
    nothing = {name: np.zeros_like(getattr(detector, name)) for name in ("score", "energy")}
    detector = detector._replace(**nothing, crossing=-1, named=-1, candidates=())
    return state._replace(detector=detector, checkpoints=checkpoints_of(state.information))


def _given_up(settings: Settings, state: State, basis: FloatArray, *, collected: bool = True) -> State:
    """Go on from the oldest checkpoint without what was known of some parameters, and with the rows since."""
    detector = state.detector
    state = state._replace(weights=detector.weights)
    information = _freed(settings, state, _oldest(state), basis)
    if collected:
        information = _stacked_factors(information, detector.collected)
    return _solved(settings, state, information)


def _root(settings: Settings, state: State, information: Information) -> FloatArray:
    """L of the covariance P = L Lᵀ of what is known; of hardly anything where parameters are not determined."""
    R = belief(settings, state._replace(information=information))
    inverse = inverse_of(R)
    return 1e6 * np.eye(len(R) - 1) if inverse is None else inverse


def _oldest(state: State) -> Information:
    return Information(*(kept[-1] for kept in state.checkpoints))


def _emptied(detector: Detector) -> Detector:
    """Forget the rows since the suspicion."""
    return detector._replace(collected=Information(*(np.zeros_like(x) for x in detector.collected)))


def _stacked(information: Information, rows: Rows) -> Information:
    """Take rows in without forgetting."""
    R, number = information.R.copy(), information.rows + np.append(rows.used.sum(axis=0), 0)
    R[:-1] = np.linalg.qr(np.concatenate([R[:-1], rows.table], axis=1), mode="r")
    return Information(R, number)


def _stacked_factors(information: Information, more: Information) -> Information:
    """Join two sets of rows of each joint."""
    R = information.R.copy()
    R[:-1] = np.linalg.qr(np.concatenate([R[:-1], more.R[:-1]], axis=1), mode="r")
    return Information(R, information.rows + more.rows)


def _union(bases: list[FloatArray]) -> FloatArray:
    """Orthonormal basis of all that some hypotheses may change."""
    U, sizes, _ = np.linalg.svd(np.hstack(bases), full_matrices=False)
    return np.asarray(U[:, sizes > SPANNED * sizes[0]])


def _freed(settings: Settings, state: State, information: Information, basis: FloatArray) -> Information:
    """Forget what is known of some parameters, and keep what is known of all others."""
    # In coordinates β = B b + C c, an R factor with b first has the information on c alone in its last rows,
    # and one with b last that on b alone.
    R = belief(settings, state._replace(information=information))
    count, freedom = basis.shape
    others = np.linalg.svd(basis)[0][:, freedom:]
    root, z = R[:-1, :-1], R[:-1, -1:]
    first = np.asarray(np.linalg.qr(np.hstack([root @ basis, root @ others, z]), mode="r"))
    last = np.asarray(np.linalg.qr(np.hstack([root @ others, root @ basis, z]), mode="r"))
    kept = np.hstack([first[freedom:count, freedom:-1] @ others.T, first[freedom:count, -1:]])
    alone = last[count - freedom : count]
    # Factor of what is known of a parameter that changed: its standard deviation grows a thousandfold
    loose = 1e-3 * np.hstack([alone[:, count - freedom : -1] @ basis.T, alone[:, -1:]])
    out, samples = np.zeros_like(information.R), np.zeros_like(information.rows)
    out[-1] = np.linalg.qr(np.vstack([kept, loose, np.zeros((1, count + 1))]), mode="r")
    independent = information.rows[:-1] / inflations(settings, state.correlation)
    samples[-1] = independent.sum() + information.rows[-1]
    return Information(out, samples)
