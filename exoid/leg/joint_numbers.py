"""Numbers of each joint that may be given as one number for all."""

from __future__ import annotations

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError


def for_joints(value: ArrayLike, n: int, what: str) -> FloatArray:
    """Spread a number over the joints, or take one for each, (n,)."""
    try:
        return np.broadcast_to(np.asarray(value, dtype=np.float64), (n,)).copy()
    except (TypeError, ValueError):
        raise BadArgumentError(
            f"{what} of {np.size(np.asarray(value))} joints for a leg of {n}",
            remedy="give one number, or one for each joint",
        ) from None
