"""Numbers of each joint that may be given as one number for all."""

from __future__ import annotations

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError
from exoid.tools.numbers import checked


def for_joints(value: ArrayLike, n: int, what: str) -> FloatArray:
    """Spread a number over the joints, or take one for each, (n,)."""
    found = checked(value, what, infinite=True)
    if found.shape not in ((), (1,), (n,)):
        remedy = "give one number, or one for each joint"
        raise BadArgumentError(f"{what} of {found.size} joints for a leg of {n}", remedy=remedy)
    return np.broadcast_to(found, (n,)).copy()
