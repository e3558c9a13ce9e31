"""Documented reduction: the parameters (X, Y, J) of a planar chain as a linear map of Pinocchio's parameters."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray

from .planar import PlanarChain
from .reduction import Reduction

MASS, MOMENT, INERTIA = 0, slice(1, 4), slice(4, 10)
"""Places of mass, first moment and inertia among Pinocchio's ten link parameters."""


def documented(chain: PlanarChain, *, cumulative: bool) -> Reduction:
    """Map link parameters π to (X1, Y1, J1, X2, Y2, J2, …), segment by segment from the torso."""
    # For each segment, with x forward, z up and d the vector to the next joint at the zero pose (doc. 1, eqs. (1)-(9)):
    #
    #     X = −m c_z − M d_z,    Y = m c_x + M d_x,    J = I_yy + M |d|²,
    #
    # with M the mass of all segments below and I_yy the inertia about the segment's own joint. With `cumulative`, J
    # also contains the J below it (doc. 1). Without, it does not (doc. 2, Table I, with its last term read as J_t).
    n = chain.n
    collect, spread = np.zeros((3 * n, 10 * n)), np.zeros((10 * n, 3 * n))
    for j, rotation in enumerate(chain.rotations):
        forward, lateral, up = (rotation.T @ direction for direction in chain.plane)
        about_lateral = quadratic_form(lateral)
        link = collect[:, 10 * j : 10 * (j + 1)]
        link[3 * j, MOMENT], link[3 * j + 1, MOMENT], link[3 * j + 2, INERTIA] = -up, forward, about_lateral
        for above in range(j):  # every segment above carries the mass of this one
            x, z = chain.offsets[above]
            link[3 * above : 3 * above + 3, MASS] = -z, x, x**2 + z**2
        carrier = spread[10 * j : 10 * (j + 1)]
        carrier[MOMENT, 3 * j], carrier[MOMENT, 3 * j + 1] = -up, forward
        carrier[INERTIA, 3 * j + 2] = tensor(lateral)
    if cumulative:
        inertias = slice(2, None, 3)
        collect[inertias] = np.cumsum(collect[inertias][::-1], axis=0)[::-1]
        spread[:, inertias] = np.diff(spread[:, inertias], prepend=0.0, axis=1)
    names = tuple(f"{symbol}{j}" for j in range(1, n + 1) for symbol in "XYJ")
    return Reduction(names, ("kg·m", "kg·m", "kg·m²") * n, collect, spread)


def quadratic_form(axis: FloatArray) -> FloatArray:
    """Coefficients of (Ixx, Ixy, Iyy, Ixz, Iyz, Izz) in axisᵀ I axis."""
    x, y, z = axis
    return np.array([x * x, 2 * x * y, y * y, 2 * x * z, 2 * y * z, z * z])


def tensor(axis: FloatArray) -> FloatArray:
    """Entries (Ixx, Ixy, Iyy, Ixz, Iyz, Izz) of the tensor axis axisᵀ, which has inertia 1 about the axis."""
    x, y, z = axis
    return np.array([x * x, x * y, y * y, x * z, y * z, z * z])
