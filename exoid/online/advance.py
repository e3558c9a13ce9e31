"""One step of the recursive estimator: a pure function from a state and a block of samples to the next state."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray

from .belief import belief
from .correlation import followed, inflations
from .detection import Detection, confirmed, looked
from .drift import drift_limit, drifted, without_epochs
from .information import absorb
from .rows import Block, Rows, filtered_rows, unfiltered_rows
from .settings import Settings
from .solution import current
from .state import Change, Detector, Information, State, begin

REMEMBERED = 100
"""Largest number of changes that a state lists."""

SETTLED = 20.0
"""Rows for each parameter from which on innovations are noise, not errors of the first values."""

CHECKPOINT = 1.0
"""Time between checkpoints over the window of the detection."""

FREED = 1e-3
"""Factor of what is known of a parameter that changed: its standard deviation grows a thousandfold."""


class Recursion(NamedTuple):
    """What a step needs beside state and samples.

    Attributes:
        settings: Settings.
        detection: Hypotheses of the change detection with their thresholds.
        drift_limit: Threshold of slow changes.
    """

    settings: Settings
    detection: Detection
    drift_limit: float

    @classmethod
    def of(cls, settings: Settings) -> Recursion:
        """Prepare the recursion.

        Args:
            settings: Settings.

        Returns:
            All that a step needs.
        """
        return cls(settings, Detection.of(settings), drift_limit(settings))

    def begin(self) -> State:
        """Make the state before the first sample.

        Returns:
            A state that knows nothing.
        """
        return begin(self.settings, len(self.detection.hypotheses))


def advance(recursion: Recursion, state: State, block: Block) -> State:
    """Take a block of samples in.

    Args:
        recursion: Settings and hypotheses.
        state: The state.
        block: As many samples as ``settings.block``; without a filter, any number.

    Returns:
        The next state; the given one is not changed.
    """
    settings = recursion.settings
    if settings.cutoff is None:
        rows = unfiltered_rows(settings, block)
    else:
        rows, state = filtered_rows(settings, state, block)
    state = state._replace(samples=state.samples + len(block.q))
    ratios = np.zeros(len(recursion.detection.hypotheses))
    if not rows.used.any():
        return _followed(settings, state, rows)
    known = np.isfinite(state.std[0]) and state.information.rows.sum() > SETTLED * settings.count
    if known and recursion.detection.on:
        inflation = inflations(settings, state.correlation)
        innovations = rows.tau - rows.W @ state.values
        detector, ratios = looked(
            settings, recursion.detection, state.detector, rows, innovations, state.weights, inflation
        )
        state = state._replace(detector=detector)
    state = _followed(settings, _updated(settings, state, rows), rows)
    if confirmed(settings, state.detector):
        return _changed(recursion, state, ratios)
    if known and np.isfinite(recursion.drift_limit):
        state = drifted(settings, recursion.drift_limit, state, rows)
    return _with_checkpoint(settings, state)


def _updated(settings: Settings, state: State, rows: Rows) -> State:
    """Take rows in, and solve."""
    information = absorb(settings, state.information, rows, state.weights)
    found = current(settings, information, state.weights, inflations(settings, state.correlation))
    if found is None:
        return state._replace(information=information)
    return state._replace(information=information, values=found.values, std=found.std, weights=found.weights)


def _followed(settings: Settings, state: State, rows: Rows) -> State:
    """Add the residuals to their autocorrelation, once values are known, and not beside a suspicion."""
    if state.detector.crossing >= 0:
        return state
    used = rows.used & np.isfinite(state.std[0])
    residuals = (rows.tau - rows.W @ state.values) * used
    return state._replace(correlation=followed(settings, state.correlation, residuals, used))


def _with_checkpoint(settings: Settings, state: State) -> State:
    """Keep the R factors every second or so."""
    every = max(1, round(CHECKPOINT * settings.window / settings.block_time))
    if state.detector.settled % every or state.detector.crossing >= 0:
        return state
    information = state.information
    return state._replace(
        checkpoints=np.concatenate([information.R[None], state.checkpoints[:-1]]),
        checkpoint_rows=np.concatenate([information.rows[None], state.checkpoint_rows[:-1]]),
    )


def _changed(recursion: Recursion, state: State, ratios: FloatArray) -> State:
    """Report a change, and go on from the oldest checkpoint with all that it knew of other parameters."""
    settings = recursion.settings
    state = state._replace(weights=state.detector.weights)
    which = recursion.detection.most_likely(ratios, state.detector)
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
    information = freed(settings, state, Information(state.checkpoints[-1], state.checkpoint_rows[-1]), one.basis)
    detector = Detector(
        np.zeros_like(state.detector.score),
        np.zeros_like(state.detector.energy),
        np.zeros_like(state.detector.level),
        0.0,
        -1,
        0,
        state.detector.weights,
    )
    found = current(settings, information, state.weights, inflations(settings, state.correlation))
    return without_epochs(settings, state)._replace(
        information=information,
        values=state.values if found is None else found.values,
        std=state.std if found is None else found.std,
        detector=detector,
        checkpoints=np.tile(information.R, (len(state.checkpoints), 1, 1, 1)),
        checkpoint_rows=np.tile(information.rows, (len(state.checkpoint_rows), 1)),
        changes=(*state.changes, change)[-REMEMBERED:],
    )


def freed(settings: Settings, state: State, information: Information, basis: FloatArray) -> Information:
    """Forget what is known of some parameters, and keep what is known of all others."""
    # In coordinates β = B b + C c, an R factor with b first has the information on c alone in its last rows,
    # and one with b last that on b alone.
    inflation = inflations(settings, state.correlation)
    R = belief(settings, state._replace(information=information))
    count, freedom = basis.shape
    others = np.linalg.svd(basis)[0][:, freedom:]
    root, z = R[:-1, :-1], R[:-1, -1:]
    first = np.asarray(np.linalg.qr(np.hstack([root @ basis, root @ others, z]), mode="r"))
    last = np.asarray(np.linalg.qr(np.hstack([root @ others, root @ basis, z]), mode="r"))
    kept = np.hstack([first[freedom:count, freedom:-1] @ others.T, first[freedom:count, -1:]])
    alone = last[count - freedom : count]
    loose = FREED * np.hstack([alone[:, count - freedom : -1] @ basis.T, alone[:, -1:]])
    out = np.zeros_like(information.R)
    table = np.vstack([kept, loose, np.zeros((1, count + 1))])
    out[-1] = np.asarray(np.linalg.qr(table, mode="r"))
    samples = np.zeros_like(information.rows)
    samples[-1] = (information.rows[:-1] / inflation).sum() + information.rows[-1]
    return Information(out, samples)


def samples_of(block: Sequence[Sequence[float]], n: int) -> Block:
    """Make a block of samples."""
    table = np.array(block, dtype=np.float64).reshape(-1, 5, n)
    return Block(table[:, 0], table[:, 1], table[:, 2], table[:, 3], table[:, 4] > 0.0)
