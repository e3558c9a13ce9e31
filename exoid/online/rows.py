"""From a block of samples to rows of τ = W β, through the causal filters."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.torques.catalog import radians

from .settings import Settings
from .state import STICKING, UNKNOWN, State


class Rows(NamedTuple):
    """Rows of τ = W β, zero where one is left out."""

    W: FloatArray  # regressor, (m, n, P)
    tau: FloatArray  # torques [N·m], (m, n)
    used: NDArray[np.bool_]  # rows of each joint that are used, (m, n)
    motion: FloatArray  # q, v and a, (3, m, n)
    slope: FloatArray  # derivative of the mean of measured and predicted torque [N·m/s], (m, n); zero without a filter

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
        W, marks = settings.model.regressor(q, v, a), _marks(settings, v, marks)
        return _kept(W, tau, marks, (q, v, a), np.zeros_like(tau)), state
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
    stretch = np.concatenate([state.columns, np.hstack([columns, tau, _marks(settings, v, marks), q, v, a])])
    c, (filtered, slopes) = len(joints), settings.decimating @ stretch
    W = np.zeros((len(filtered), n, settings.count))
    W[:, joints, parameters] = filtered[:, :c]
    tau, marks, *motion = np.split(filtered[:, c:], 5, axis=1)
    predicted = (slopes[:, :c] * state.detector.values[parameters]) @ (joints[:, None] == np.arange(n))
    # A late torque differs from its prediction by the delay times the mean of both slopes, to the third order
    rows, keep = _kept(W, tau, marks, motion, 0.5 * (predicted + slopes[:, c : c + n])), settings.histories
    return rows, state._replace(motion=samples[-keep[0] :], columns=stretch[-keep[1] :])


def _marks(settings: Settings, v: FloatArray, marks: FloatArray) -> FloatArray:
    """Add marks where a joint may stick, or is in the dead band of its friction, (k, n)."""
    sticks = settings.sticking & (np.abs(v) < settings.reversal_speed * radians(settings.model.leg))
    return marks + np.where(sticks | ~settings.model.usable(v), STICKING, 0.0)


def _kept(W: FloatArray, tau: FloatArray, marks: FloatArray, motion: Sequence[FloatArray], slope: FloatArray) -> Rows:
    used = marks < 0.05  # the share of a row that samples may have at which a joint may stick
    return Rows(W * used[:, :, None], tau * used, used, np.array(motion), slope * used)


def faults_of(settings: Settings, rows: Rows, values: FloatArray) -> FloatArray:
    """Innovations by a unit of each fault, see `SENSOR_FAULTS`, (n, m, 3 n)."""
    (m, n), unit = rows.tau.shape, np.eye(settings.n)
    scale, late = (x.T[..., None] * (unit * settings.driven)[:, None] for x in (rows.W @ values, -rows.slope))
    moved = np.tile(rows.motion, (1, 2 * n, 1))
    moved[0] += np.repeat(1e-3 * np.vstack([unit, -unit]), m, axis=0)  # [rad]
    more, less = (settings.model.regressor(*moved) @ values).reshape(2, n, m, n) * rows.used
    return np.concatenate([scale, (less - more).transpose(2, 1, 0) / 2e-3, late], axis=2)
