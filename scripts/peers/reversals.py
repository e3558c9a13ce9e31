"""What reversals of friction cost a plain least-squares fit: rows near them left in or out; errors as in compare.py.

OMP_NUM_THREADS=1 python scripts/peers/reversals.py  # seconds
"""

from __future__ import annotations

import numpy as np
from task import Rows, Task, read_as_parameters, swing

import exoid
from exoid._typing import BoolArray, FloatArray

AROUND = 0.1
"""Time around a reversal whose rows are left out [s]."""


def near_reversals(rows: Rows, rate: float) -> BoolArray:
    """Find the rows near a change of a velocity's sign.

    Args:
        rows: The samples.
        rate: Sampling rate [Hz].

    Returns:
        True near a reversal of the joint, (N, n).
    """
    turns = np.diff(np.sign(rows.v), axis=0, append=np.sign(rows.v[-1:])) != 0.0
    window = np.ones(2 * round(AROUND * rate) + 1)
    return np.stack([np.convolve(turn, window, mode="same") > 0.0 for turn in turns.T], axis=1)


def regressor(leg: exoid.Leg, rows: Rows) -> FloatArray:
    """Columns of bodies, friction, rotors and offsets, (N, n, p).

    Args:
        leg: The leg.
        rows: The samples.

    Returns:
        The regressor; the rotor of the first joint is part of J1.
    """
    each = np.eye(rows.q.shape[1])
    blocks = [np.einsum("ni,ij->nij", x, each) for x in (np.sign(rows.v), rows.v, rows.a, np.ones_like(rows.v))]
    return np.concatenate([leg.regressor(*rows[:3]), *blocks[:2], blocks[2][..., 1:], blocks[3]], axis=-1)


def errors(task: Task, kept: BoolArray) -> str:
    """Fit the kept rows and compare with the truth.

    Args:
        task: The task.
        kept: Rows of the fit, (N, n).

    Returns:
        Worst relative errors, in words.
    """
    assert task.truth is not None
    rows = task.train.rows(task.cutoff)
    found = np.linalg.lstsq(regressor(task.leg, rows)[kept], rows.tau[kept], rcond=None)[0]
    true = read_as_parameters(task.leg, task.truth)
    error = {name: abs(x / value - 1.0) for (name, value), x in zip(true.items(), found, strict=False)}
    worst = [max(x for name, x in error.items() if name[0] in group) for group in ("XJ", "cd")]
    return f"X, J {100 * worst[0]:.1f} %, c, d {100 * worst[1]:.1f} %"


if __name__ == "__main__":
    for seed in (1, 2, 3):
        task = swing(seed)
        near = near_reversals(task.train.rows(task.cutoff), task.train.rate)
        print(f"seed {seed}: all rows {errors(task, ~np.zeros_like(near))}; without reversals {errors(task, ~near)}")
