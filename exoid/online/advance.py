"""One step of the recursive estimator: a pure function from a state and a block of samples to the next state."""

from __future__ import annotations

import numpy as np

from exoid._typing import BoolArray, FloatArray
from exoid.regression.least_squares import RANK

from .changes import Verdict, judge, look
from .hypotheses import SENSOR_FAULTS
from .information import absorb
from .rows import Rows, faults_of, rows_of
from .settings import Settings
from .solution import belief, follow_residuals, solved
from .state import Change, Detector, Information, State

DECISION, PROBATION = 1.5, 20.0
"""Time from a suspicion to the first name of what changed, and for which rows are collected after it: a wrong name is
found out, and taken back [s]."""


def advance(settings: Settings, state: State, samples: FloatArray) -> State:
    """Take a block of samples in: as many as ``settings.block``; without a filter, any number."""
    # Columns are q, v, a, τ, and marks of torques that are not to be used, (k, 5 n). v is NaN where it follows from the
    # angles, and a where it follows from the velocities.
    rows, state = rows_of(settings, state, samples)
    state = state._replace(samples=state.samples + len(samples))
    if state.detector.crossing >= 0:
        return _suspect(settings, state, rows) if rows.used.any() else state
    # from 20 rows for each parameter on, innovations are noise, not errors of the first values
    known = np.isfinite(state.std[0]) and state.information.rows.sum() > 20.0 * settings.count
    used = rows.used & known
    if not rows.used.any():
        return _with_residuals(settings, state, rows, used)
    if known and np.isfinite(settings.detection.limits).all():
        detector = look(settings, state, rows)
        state = state._replace(detector=detector, sharpest=np.maximum(state.sharpest, detector.weights))
        if detector.crossing >= 0:  # the estimate holds; the oldest checkpoint is what was known before the change
            before = solved(settings, state._replace(weights=detector.weights), state.checkpoints[-1])
            return state._replace(detector=_emptied(detector)._replace(values=before.values))
    state = solved(settings, state, absorb(settings, state.information, rows, state.weights))
    state = _with_residuals(settings, state, rows, used)
    if state.detector.settled % max(1, round(1.0 / settings.block_time)):
        return state
    return state._replace(checkpoints=(state.information, *state.checkpoints[:-1]))


def _with_residuals(settings: Settings, state: State, rows: Rows, used: BoolArray) -> State:
    """Add the residuals of some rows to their autocorrelation."""
    residuals = (rows.tau - rows.W @ state.values) * used
    return state._replace(correlation=follow_residuals(settings, state.correlation, residuals, used))


def _suspect(settings: Settings, state: State, rows: Rows) -> State:
    """Collect rows, and go on from before the change without what the candidates may have changed."""
    detector = state.detector._replace(crossing=state.detector.crossing + 1)
    since = detector.crossing * settings.block_time
    if since > 2.0 * settings.delay:  # rows behind the filters are of one leg alone
        number, (R, before) = np.append(rows.used.sum(axis=0), 0), detector.collected
        if since > PROBATION:  # a fault of a sensor lasts; old rows fade, so that its end is noticed
            share = settings.block_time / PROBATION
            R, before = R * np.sqrt(1.0 - share), before * (1.0 - share)
        table = np.concatenate([rows.table, faults_of(settings, rows, detector.values)], axis=2)
        detector = detector._replace(collected=_joined(Information(R, before), table, number))
    state = state._replace(detector=detector)
    if since <= DECISION + settings.delay:
        return state
    verdict = judge(settings, state)
    if verdict.torn:  # a second change, or none: everything may have changed, and rows from now on say what
        every = tuple(range(len(settings.detection.hypotheses)))
        emptied = _emptied(detector)._replace(crossing=0, candidates=every)
        return _given_up(settings, state._replace(detector=emptied), np.eye(settings.count))
    if verdict.best < 0:  # whatever it was, it is over: the change is taken back
        held = state.checkpoints[-1] if detector.candidates else state.information
        wrong = detector.named >= 0 and since <= PROBATION  # later, a fault of a sensor was mended
        state = state._replace(changes=state.changes[: len(state.changes) - wrong], weights=detector.weights)
        return _settle(solved(settings, state, _joined(held, detector.collected.R[:-1], detector.collected.rows)))
    basis, possible = np.eye(settings.count), [settings.detection.hypotheses[k] for k in verdict.candidates]
    faulty = any(one.kind in SENSOR_FAULTS for one in possible)  # the rows may then be wrong
    if verdict.complete:  # all that the candidates may change
        U, sizes, _ = np.linalg.svd(np.hstack([one.basis[: settings.count] for one in possible]), full_matrices=False)
        basis = U[:, sizes > RANK * max(sizes[0], RANK)]
    state = _given_up(settings, state, basis, learn=not faulty)
    over = since > PROBATION
    if verdict.best != detector.named and (over or len(verdict.candidates) == 1):
        state = _named(settings, state, verdict)
    state = state._replace(detector=state.detector._replace(candidates=verdict.candidates))
    return _settle(state) if over and not faulty else state


def _named(settings: Settings, state: State, verdict: Verdict) -> State:
    """Report a change, in place of another name that was reported for the same rows."""
    detector, one = state.detector, settings.detection.hypotheses[verdict.best]
    what, values = (one.kind, one.joint, one.parameters, verdict.ratio, verdict.size), tuple(detector.values.tolist())
    change = Change(state.samples, state.samples / settings.rate, *what, values)
    earlier = state.changes[: len(state.changes) - (detector.named >= 0)]
    kept = (*earlier, change)[-100:]  # so that the state of a stream of weeks does not grow
    return state._replace(detector=detector._replace(named=verdict.best), changes=kept)


def _settle(state: State) -> State:
    """End a suspicion; the mean of the statistics stays that of this motion."""
    detector = _emptied(state.detector)._replace(crossing=-1)
    return state._replace(detector=detector, checkpoints=(state.information,) * 3)


def _emptied(detector: Detector) -> Detector:
    """Forget innovations, the rows since the suspicion, and what they said."""
    collected = Information(*(np.zeros_like(x) for x in detector.collected))
    score, energy = np.zeros_like(detector.score), np.zeros_like(detector.energy)
    return detector._replace(score=score, energy=energy, collected=collected, named=-1, candidates=())


def _joined(information: Information, table: FloatArray, number: FloatArray) -> Information:
    """Take rows of each joint in without forgetting; columns of faults only where the information has them."""
    R = information.R.copy()
    R[:-1] = np.linalg.qr(np.concatenate([R[:-1], table[..., : R.shape[2]]], axis=1), mode="r")
    return Information(R, information.rows + number)


def _given_up(settings: Settings, state: State, basis: FloatArray, *, learn: bool = True) -> State:
    """Go on from the oldest checkpoint without what was known of some parameters, and with the rows since."""
    # In coordinates β = B b + C c, an R factor with b first has the information on c alone in its last rows,
    # and one with b last that on b alone.
    state = state._replace(weights=state.detector.weights, information=state.checkpoints[-1])
    if not basis.size:  # sensors failed
        return solved(settings, state, state.information)
    R, (count, freedom) = belief(settings, state), basis.shape
    others = np.linalg.svd(basis)[0][:, freedom:]
    root, z = R[:-1, :-1], R[:-1, -1:]
    first = np.asarray(np.linalg.qr(np.hstack([root @ basis, root @ others, z]), mode="r"))
    last = np.asarray(np.linalg.qr(np.hstack([root @ others, root @ basis, z]), mode="r"))
    kept = np.hstack([first[freedom:count, freedom:-1] @ others.T, first[freedom:count, -1:]])
    alone = last[count - freedom : count]
    # Factor of what is known of a parameter that changed: its standard deviation grows to more than any change
    loose = 1e-5 * np.hstack([alone[:, count - freedom : -1] @ basis.T, alone[:, -1:]])
    freed, samples = np.zeros_like(state.information.R), np.zeros_like(state.information.rows)
    freed[-1] = np.linalg.qr(np.vstack([kept, loose, np.zeros((1, count + 1))]), mode="r")
    rows = state.information.rows
    samples[-1] = (rows[:-1] / state.correlation.inflation).sum() + rows[-1]
    known, collected = Information(freed, samples), state.detector.collected
    return solved(settings, state, _joined(known, collected.R[:-1], collected.rows) if learn else known)
