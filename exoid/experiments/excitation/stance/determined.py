"""Which parameters motions with some supports can determine at all, and which support is missing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from exoid._typing import FloatArray
from exoid.experiments.excitation.fourier import States
from exoid.experiments.excitation.limits import MotionLimits
from exoid.experiments.excitation.scales import ACCELERATION, SPEED
from exoid.regression.least_squares import INVOLVED, RANK

from .demands import Demands

EVERY = "all of them can be determined"
"""End of the sentence about supports that leave nothing undetermined."""

STATES = 400
"""Number of random states of each support."""


def null_space(demands: Sequence[Demands], limits: Sequence[MotionLimits], scale: FloatArray) -> FloatArray:
    """Find combinations of parameters that no motion with these supports determines."""
    rng, rows = np.random.default_rng(0), []
    for one, box in zip(demands, limits, strict=True):
        even = rng.uniform(-1.0, 1.0, (3, STATES, len(box.lower)))
        states = States(
            0.5 * (box.lower + box.upper) + 0.5 * box.span * even[0], SPEED * even[1], ACCELERATION * even[2]
        )
        columns = one.at(states).columns * scale[:, None, None]
        rows.append(columns.reshape(len(scale), -1).T)
    W = np.linalg.qr(np.vstack(rows), mode="r")
    size = np.linalg.norm(W, axis=0)
    size = np.where(size > RANK * size.max(), size, size.max())  # a foot at rest leaves only rounding
    _, sigma, Vt = np.linalg.svd(W / size)
    loose = Vt[sigma <= RANK * sigma[0]].T / size[:, None]
    return np.asarray(np.linalg.qr(loose)[0])


def undetermined(names: Sequence[str], null: FloatArray) -> tuple[str, ...]:
    """Name the parameters that are part of such combinations."""
    part = np.linalg.norm(null, axis=1)
    return tuple(name for name, size in zip(names, part, strict=True) if size > INVOLVED)


def missing_support(names: Sequence[str], loose: Sequence[str], added: Sequence[str], null: FloatArray) -> str:
    """Say what motions with further supports would determine."""
    still = set(undetermined(names, null))
    more = [name for name in loose if name not in still]
    if not more or not added:
        return ""
    what = EVERY if len(more) == len(loose) else f"{', '.join(more)} can be determined"
    return f"with motions on {' and '.join(added)} as well: {what}"
