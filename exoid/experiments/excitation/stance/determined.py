"""Which parameters motions with some supports can determine at all, and which support is missing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from exoid._typing import FloatArray
from exoid.experiments.excitation.limits import MotionLimits
from exoid.experiments.excitation.scales import STATES, Scales, reference_states
from exoid.regression.least_squares import INVOLVED, RANK

from .demands import Demands

EVERY = "all of them can be determined"
"""End of the sentence about supports that leave nothing undetermined."""


def null_space(demands: Sequence[Demands], limits: Sequence[MotionLimits], scale: FloatArray) -> FloatArray:
    """Find combinations of parameters that no motion with these supports determines."""
    rng, rows = np.random.default_rng(0), []
    for one, box in zip(demands, limits, strict=True):
        states = reference_states(box, 400, rng)
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


def stance_scales(demands: Sequence[Demands], limits: Sequence[MotionLimits]) -> Scales:
    """Compute the scales over random states of standing on each foot, see :class:`Scales`."""
    rng, tables = np.random.default_rng(0), []
    for one, box in zip(demands, limits, strict=True):
        inverse = np.linalg.inv(one.support.spread)  # of one foot: a permutation of the joints
        columns = one.at(reference_states(box, STATES, rng)).columns
        tables.append(np.einsum("jk,pks->sjp", inverse, columns))
    return Scales.over(demands[0].expected, np.vstack(tables))
