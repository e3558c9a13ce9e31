"""Regressor of base parameters: columns of Pinocchio's regressor, combined where a reduction says so."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray

from .reduction import Reduction
from .tree import Tree
from .tree_regressor import BaseSamples, fill_tree_regressor

BLOCK = 2048
"""Samples combined at once, which limits the memory of Pinocchio's wide regressor."""


def fill_reduced_regressor(
    reduction: Reduction,
    tree: Tree,
    q: FloatArray,
    v: FloatArray,
    a: FloatArray,
    out: FloatArray,
    base: BaseSamples | None = None,
) -> None:
    """Write the regressor of base parameters of every sample."""
    columns, spread = reduction.columns, reduction.spread
    if reduction.selects:
        fill_tree_regressor(tree, q, v, a, columns, out, base)
        return
    for start in range(0, len(q), BLOCK):
        rows = slice(start, start + BLOCK)
        part = out[..., rows]
        Y = np.zeros((len(columns), *part.shape[1:]))
        moved = None if base is None else BaseSamples(*(x[rows] for x in base))
        fill_tree_regressor(tree, q[rows], v[rows], a[rows], columns, Y, moved)
        part[:] = np.tensordot(spread[columns].T, Y, axes=1)
