"""Numbers of each joint that may be given as one number for all."""

from __future__ import annotations

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError


def for_joints(value: ArrayLike, n: int, what: str) -> FloatArray:
    """Spread a number over the joints, or take one for each, (n,)."""
    remedy = "give one number, or one for each joint"
    try:
        found = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise BadArgumentError(f"{what} is {value!r}", remedy=remedy) from None
    if found.shape not in ((), (1,), (n,)):
        raise BadArgumentError(f"{what} of {found.size} joints for a leg of {n}", remedy=remedy)
    return np.broadcast_to(found, (n,)).copy()
