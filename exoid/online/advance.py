"""One step of the recursive estimator: a pure function from a state and a block of samples to the next state."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray

from .changes import Detection, confirmed, look
from .drift import drift_limit, follow_epochs
from .information import absorb
from .rows import Block, Rows, rows_of
from .settings import Settings
from .solution import belief, current, follow_residuals, inflations
from .state import REMEMBERED, Change, Information, State, begin, checkpoints_of, no_epochs

SETTLED = 20.0
"""Rows for each parameter from which on innovations are noise, not errors of the first values."""


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
    ratios = np.zeros(len(detection.hypotheses))
    known = np.isfinite(state.std[0]) and state.information.rows.sum() > SETTLED * settings.count
    if known and detection.on:
        inflation, innovations = inflations(settings, state.correlation), rows.tau - rows.W @ state.values
        detector, ratios = look(settings, detection, state.detector, rows, innovations, state.weights, inflation)
        state = state._replace(detector=detector)
    state = _solved(settings, state, absorb(settings, state.information, rows, state.weights))
    state = _with_residuals(settings, state, rows)
    if confirmed(settings, state.detector):
        return _changed(recursion, state, ratios)
    if known and np.isfinite(recursion.drift_limit):
        state = follow_epochs(settings, recursion.drift_limit, state, rows)
    if state.detector.settled % max(1, round(settings.window / settings.block_time)) or state.detector.crossing >= 0:
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


def _changed(recursion: Recursion, state: State, ratios: FloatArray) -> State:
    """Report a change, and go on from the oldest checkpoint with all that it knew of other parameters."""
    settings, detector = recursion.settings, state.detector
    state = state._replace(weights=detector.weights)
    which = recursion.detection.most_likely(ratios, detector)
    one = recursion.detection.hypotheses[which]
    change = Change(
        sample=state.samples,
        time=state.samples / settings.rate,
        kind=one.kind,
        joint=one.joint,
        parameters=one.parameters,
        statistic=float(ratios[which]),
        values=tuple(state.values.tolist()),
    )
    information = _freed(settings, state, Information(*(kept[-1] for kept in state.checkpoints)), one.basis)
    nothing = {name: np.zeros_like(getattr(detector, name)) for name in ("score", "energy", "level")}
    return _solved(settings, state, information)._replace(
        detector=detector._replace(**nothing, looks=0.0, crossing=-1, settled=0),
        checkpoints=checkpoints_of(information),
        changes=(*state.changes, change)[-REMEMBERED:],
        epochs=no_epochs(settings),
    )


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
