"""Names for the array types used throughout."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

ComplexArray = NDArray[np.complex128]
FloatArray = NDArray[np.float64]

__all__ = ["ArrayLike", "ComplexArray", "FloatArray"]
