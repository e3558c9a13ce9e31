"""Numbers that somebody gives: finite, within bounds, and of few dimensions."""

from __future__ import annotations

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError

ROUNDED = 1e-9
"""Error that is rounding: of unit vectors, of equal places [m], of an angle at its limit [rad], and the like."""


def checked(
    value: ArrayLike,
    what: str,
    *,
    above: float = -np.inf,
    least: float = -np.inf,
    most: float = np.inf,
    infinite: bool = False,
    ndim: int = 1,
) -> FloatArray:
    """Convert to a read-only array; refuse what is not a number, not within the bounds, or has more dimensions."""
    kind, bounds = "numbers" if infinite else "finite numbers", ((">", above), ("≥", least), ("≤", most))
    remedy = f"give {kind}{' and'.join(f' {sign} {bound:g}' for sign, bound in bounds if np.isfinite(bound))}"
    try:
        array = np.asarray(value).astype(np.float64, casting="same_kind")  # not of "8", which remains a text elsewhere
    except (TypeError, ValueError):
        raise BadArgumentError(f"{what} is {value!r}", remedy=remedy) from None
    good = (array > above) & (array >= least) & (array <= most) & (np.isfinite(array) | infinite)  # NaN is never good
    if array.ndim > ndim or not good.all():
        wrong = array.tolist() if array.size < 10 else array[~good][:1].tolist() or f"of shape {array.shape}"
        raise BadArgumentError(f"{what} is {wrong}", remedy=remedy)
    array.flags.writeable = False
    return array


def is_number(value: object) -> bool:
    """Tell whether a value is a finite real number; integers may have any number of digits."""
    return isinstance(value, int | float) and not isinstance(value, bool) and -1e300 < value < 1e300
