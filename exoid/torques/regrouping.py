"""Parameters of terms that no motion distinguishes from others."""

from __future__ import annotations

from collections.abc import Container, Sequence
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.regression.least_squares import column_scale

DEPENDENT = 2e-4
"""A unit column this close to the span of the columns before it is linearly dependent on them.

A URDF with four decimals misplaces joint axes by up to 5e-5 rad and m, and columns of inertias by a few times as much.
At a threshold of floating-point precision a rotor would not merge into its link there. Its standard deviation would
then be thousands of times that of the link's inertia.
"""


class Regrouped(NamedTuple):
    """A parameter that no motion can distinguish from others, which therefore include it.

    Attributes:
        name: Name of the parameter.
        into: Names of the parameters that include it, with its coefficient in each.
    """

    name: str
    into: dict[str, float]

    def __str__(self) -> str:
        """Write one sentence."""
        into = ", ".join(n if abs(c - 1.0) < 1e-6 else f"{n} (× {c:.3g})" for n, c in self.into.items())
        return f"{self.name} is regrouped into {into}: no motion distinguishes them"


def regroup(
    columns: FloatArray, names: Sequence[str], of_leg: int, apart: Container[str], loaded: Container[str]
) -> tuple[Regrouped, ...]:
    """Find columns of terms, (P, R, N) behind those of the leg, that depend linearly on others, but for those apart."""
    # Each column is compared with those before it. Terms that depend on the load are left to the fit: their columns
    # depend on the parameters.
    W = columns.transpose(2, 1, 0).reshape(-1, len(names))
    scale = column_scale(W)
    R = np.asarray(np.linalg.qr(W / scale, mode="r"))  # small: a seven-joint arm has 80 columns
    kept, regrouped = list(range(of_leg)), []
    for k in (k for k in range(of_leg, len(names)) if names[k] not in loaded):
        share, *_ = np.linalg.lstsq(R[:, kept], R[:, k])
        if R[:, k].any() and np.linalg.norm(R[:, k] - R[:, kept] @ share) < DEPENDENT:
            if names[k] in apart:
                continue
            coefficients = zip(kept, share, share * scale[k] / scale[kept], strict=True)
            into = {names[i]: float(c) for i, part, c in coefficients if abs(part) > DEPENDENT}
            regrouped.append(Regrouped(names[k], into))
        else:
            kept.append(k)
    return tuple(regrouped)
