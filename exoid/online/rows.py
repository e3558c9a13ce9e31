"""From a block of samples to rows of τ = W β, through the causal filters."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray

from .settings import Settings
from .state import STICKING, UNKNOWN, State

TOUCHED = 0.05
"""Largest share of a row that samples may have at which a joint may stick."""


class Rows(NamedTuple):
    """Rows of τ = W β, zero where one is left out."""

    W: FloatArray  # regressor, (m, n, P)
    tau: FloatArray  # torques [N·m], (m, n)
    used: NDArray[np.bool_]  # rows of each joint that are used, (m, n)

    @property
    def table(self) -> FloatArray:
        """[W τ] of each joint, (n, m, P + 1)."""
        return np.concatenate([self.W, self.tau[..., None]], axis=2).transpose(1, 0, 2)


def rows_of(settings: Settings, state: State, samples: FloatArray) -> tuple[Rows, State]:
    """Smooth and differentiate a block (k, 5 n), see `advance`, form columns, and filter columns and torques alike."""
    n, samples = settings.n, samples.copy()
    samples[:, 4 * n :] *= UNKNOWN
    if settings.cutoff is None:
        q, v, a, tau, marks = np.split(samples, 5, axis=1)
        return _kept(settings.model.regressor(q, v, a), tau, _marks(settings, v, marks) < TOUCHED), state
    given = ~np.isnan(samples[0, [n, 2 * n]])
    samples = np.concatenate([state.motion, np.nan_to_num(samples)])
    smooth, first, second = settings.smoothing
    q, v, a, tau, _ = np.split(smooth @ samples, 5, axis=1)
    marks = np.abs(smooth) @ samples[:, 4 * n :]  # weights of either sign must not cancel marks
    if not given[0]:
        v = first @ samples[:, :n]
    if not given[1]:
        a = first @ samples[:, n : 2 * n] if given[0] else second @ samples[:, :n]
    parameters, joints = settings.acting
    columns = settings.model.columns(settings.model.motion(q, v, a))[parameters, joints].T
    stretch = np.concatenate([state.columns, np.hstack([columns, tau, _marks(settings, v, marks)])])
    filtered = settings.decimating @ stretch
    W = np.zeros((len(filtered), n, settings.count))
    W[:, joints, parameters] = filtered[:, : len(joints)]
    rows = _kept(W, filtered[:, len(joints) : -n], filtered[:, -n:] < TOUCHED)
    keep = settings.histories
    return rows, state._replace(motion=samples[-keep[0] :], columns=stretch[-keep[1] :])


def _marks(settings: Settings, v: FloatArray, marks: FloatArray) -> FloatArray:
    """Add marks where a joint may stick, or is in the dead band of its friction, (k, n)."""
    sticks = settings.sticking & (np.abs(v) < settings.reversal_speed)
    return marks + np.where(sticks | ~settings.model.usable(v), STICKING, 0.0)


def _kept(W: FloatArray, tau: FloatArray, used: NDArray[np.bool_]) -> Rows:
    return Rows(W * used[:, :, None], tau * used, used)
