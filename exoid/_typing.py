"""Names for the array types used throughout."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

BoolArray = NDArray[np.bool_]
ComplexArray = NDArray[np.complex128]
FloatArray = NDArray[np.float64]

__all__ = ["ArrayLike", "BoolArray", "ComplexArray", "FloatArray"]
