"""State of a recursive estimator: all that it knows, in arrays whose sizes never change."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray

from .hypotheses import SENSOR_FAULTS
from .settings import LAGS, Settings

UNKNOWN, STICKING = 1e6, 1.0
"""Marks of a sample that must not touch a row, and of one at which a joint may stick."""

WARM_UP = 5.0
"""Time with rows before changes are reported, and for which the mean statistic counts as 1 beforehand [s]."""


class Information(NamedTuple):
    """R factors of the rows so far: R β = z with noise of the size of the rows'."""

    # R factors [R z] of the rows of each joint, and last what was known before them, scaled to noise of unit
    # size, (n + 1, P + 1, P + 1)
    R: FloatArray
    # rows of each joint, forgotten ones not counted, and samples behind what was known before, (n + 1,)
    rows: FloatArray


class Correlation(NamedTuple):
    """Autocorrelation of the residuals of each joint, over up to K = `LAGS` rows."""

    tail: FloatArray  # the last residuals [N·m], zero where a row was left out, (K, n)
    used: FloatArray  # whether they were used, 0 or 1, (K, n)
    sums: FloatArray  # discounted sum of products of residuals k rows apart, (K + 1, n)
    counts: FloatArray  # discounted number of them, (K + 1, n)
    inflation: FloatArray  # rows that say as much as one independent row, (n,)


class Detector(NamedTuple):
    """State of the change detection, with C hypotheses."""

    score: FloatArray  # discounted Wᵀe of weighted innovations, (P,)
    energy: FloatArray  # discounted WᵀW of the same rows, (P, P)
    level: FloatArray  # discounted sum of the statistic of each hypothesis, (C,)
    looks: float  # discounted number of blocks in it
    crossing: int  # blocks since a statistic crossed its threshold; −1 for none
    settled: int  # blocks with rows since the beginning, or since the last change
    weights: FloatArray  # weight of the rows of each joint, followed slowly and not beside a suspicion [1/(N·m)], (n,)
    values: FloatArray  # parameters before the suspicion, (P,)
    collected: Information  # [R z F] of the rows since the suspicion, with columns of faults
    named: int  # place of the hypothesis that was reported for these rows; −1 for none
    candidates: tuple[int, ...]  # places of the hypotheses that may have changed

    @property
    def mean(self) -> FloatArray:
        """Mean statistic of each hypothesis while nothing changes, at least 1, (C,)."""
        return np.maximum(1.0, self.level / max(self.looks, 1.0))


class Change(NamedTuple):
    """Change of parameters that was detected.

    Attributes:
        sample: Samples that had been received when it was detected.
        time: The same [s].
        kind: "load" (of a segment: a payload), "friction", "offset", "inertia" (of a rotor), "stiffness", or the name
            of another term; "torque-scale", "angle-offset" or "torque-delay" of a sensor.
        joint: Joint of the friction or sensor, or the joint that carries the segment with the load; "" for all.
        parameters: Parameters that changed; none by a fault of a sensor.
        statistic: Statistic over its threshold.
        size: Change of a torque's scale, of an angle's zero [rad], or delay [s]; NaN for parameters.
        values: All parameters before the change, (P,).
    """

    sample: int
    time: float
    kind: str
    joint: str
    parameters: tuple[str, ...]
    statistic: float
    size: float
    values: tuple[float, ...]

    def __str__(self) -> str:
        """Write one sentence."""
        where = f" at {self.joint}" if self.joint else ""
        what = ", ".join(self.parameters) or f"{self.size:+.3g}{SENSOR_FAULTS[self.kind]}"
        return f"{self.time:.2f} s: {self.kind}{where} changed ({what})"


class State(NamedTuple):
    """All that a recursive estimator knows."""

    samples: int  # number of samples, those that were left out included
    motion: FloatArray  # last samples of q, v, a, τ and of the marks of each joint, for the first filter, (h1, 5 n)
    columns: FloatArray  # last samples of columns, torques, marks, q, v, a for the second filter, (h2, c + 5 n)
    information: Information  # what the rows say
    values: FloatArray  # parameters by the last block, (P,)
    std: FloatArray  # their standard deviations by the R factors alone, (P,); infinite before they are determined
    weights: FloatArray  # weight of the rows of each joint [1/(N·m)], (n,)
    sharpest: FloatArray  # largest slowly followed weight so far, (n,)
    correlation: Correlation
    detector: Detector
    checkpoints: tuple[Information, ...]  # information one, two and three seconds ago, for the case of a change
    changes: tuple[Change, ...]  # the last hundred at most
    slips: FloatArray  # samples before the angle of each joint jumped and stayed, (n,)


def begin(settings: Settings) -> State:
    """Make the state before the first sample, which knows nothing."""
    n, P, hypotheses = settings.n, settings.count, len(settings.detection.hypotheses)
    R, rows = np.zeros((n + 1, P + 1, P + 1)), np.zeros(n + 1)
    lags = (np.zeros((LAGS, n)),) * 2 + (np.zeros((LAGS + 1, n)),) * 2
    looks = WARM_UP / settings.block_time
    state = State(
        samples=0,
        motion=np.zeros((settings.histories[0], 5 * n)),
        columns=np.zeros((settings.histories[1], len(settings.acting[0]) + 5 * n)),
        information=Information(R, rows),
        values=np.zeros(P),
        std=np.full(P, np.inf),
        weights=np.ones(n),
        sharpest=np.zeros(n),
        correlation=Correlation(*lags, np.full(n, settings.filter_inflation)),
        detector=Detector(
            score=np.zeros(P),
            energy=np.zeros((P, P)),
            level=np.full(hypotheses, looks),
            looks=looks,
            crossing=-1,
            settled=0,
            weights=np.ones(n),
            values=np.zeros(P),
            collected=Information(np.zeros((n + 1, *[P + 1 + len(SENSOR_FAULTS) * n] * 2)), rows),
            named=-1,
            candidates=(),
        ),
        checkpoints=(Information(R, rows),) * 3,
        changes=(),
        slips=np.full(n, -np.inf),
    )
    return restarted(settings, state)


def restarted(settings: Settings, state: State, slipped: tuple[int, ...] = ()) -> State:
    """Forget the last samples, as after a gap or where encoders slipped: rows come again when the filters are full."""
    n, slips = settings.n, state.slips.copy()
    slips[list(slipped)] = state.samples
    motion, columns = np.zeros_like(state.motion), np.zeros_like(state.columns)
    motion[:, 4 * n :] = UNKNOWN
    columns[:, len(settings.acting[0]) + n :][:, :n] = UNKNOWN
    correlation = state.correlation._replace(tail=np.zeros((LAGS, n)), used=np.zeros((LAGS, n)))
    return state._replace(motion=motion, columns=columns, correlation=correlation, slips=slips)
