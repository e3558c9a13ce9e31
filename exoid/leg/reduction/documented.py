"""Documented reduction of planar machines as a linear map of Pinocchio's parameters.

The parameters are (X, Y, J) of each segment, and M, X0, Y0, J0 of a floating torso.
"""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray

from .planar import PlanarChain
from .planar_machine import TORSO_PARAMETERS, PlanarMachine
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
        about_lateral = _quadratic_form(lateral)
        link = collect[:, 10 * j : 10 * (j + 1)]
        link[3 * j, MOMENT], link[3 * j + 1, MOMENT], link[3 * j + 2, INERTIA] = -up, forward, about_lateral
        for above in range(j):  # every segment above carries the mass of this one
            x, z = chain.offsets[above]
            link[3 * above : 3 * above + 3, MASS] = -z, x, x**2 + z**2
        carrier = spread[10 * j : 10 * (j + 1)]
        carrier[MOMENT, 3 * j], carrier[MOMENT, 3 * j + 1] = -up, forward
        carrier[INERTIA, 3 * j + 2] = _tensor(lateral)
    if cumulative:
        inertias = slice(2, None, 3)
        collect[inertias] = np.cumsum(collect[inertias][::-1], axis=0)[::-1]
        spread[:, inertias] = np.diff(spread[:, inertias], prepend=0.0, axis=1)
    names = tuple(f"{symbol}{j}" for j in range(1, n + 1) for symbol in "XYJ")
    return Reduction(names, ("kg·m", "kg·m", "kg·m²") * n, collect, spread)


def documented_machine(machine: PlanarMachine, hip: FloatArray, *, cumulative: bool) -> Reduction:
    """Map link parameters π to (X1_left, Y1_left, J1_left, X2_left, …), limb by limb."""
    # A floating torso has its own ten parameters in π before those of the links, and M, X0, Y0, J0 before those
    # of the limbs. With M_l the mass of limb l and d_l the place of its hip, counted from the hip of the
    # machine, the definition continues that of a segment:
    #
    #     M = m + Σ M_l,    X0 = −m c_z − Σ M_l d_z,    Y0 = m c_x + Σ M_l d_x,    J0 = I_yy + Σ M_l |d_l|²,
    #
    # with the torso's mass m, centre of mass c and inertia I_yy about the hip. With `cumulative`, J0 also contains J1
    # of every limb, as each J contains the J below it (doc. 1).
    n, own, ten = machine.n, len(TORSO_PARAMETERS) * machine.floating, 10 * machine.floating
    collect, spread = np.zeros((own + 3 * n, ten + 10 * n)), np.zeros((ten + 10 * n, own + 3 * n))
    names, units = list(TORSO_PARAMETERS)[:own], list(TORSO_PARAMETERS.values())[:own]
    for limb in machine.limbs:
        reduction = documented(limb.chain, cumulative=cumulative)
        columns = slice(own + limb.parameters.start, own + limb.parameters.stop)
        links = slice(ten + 10 * limb.joints.start, ten + 10 * limb.joints.stop)
        collect[columns, links], spread[links, columns] = reduction.collect, reduction.spread
        names += [f"{name}_{limb.label}" if limb.label else name for name in reduction.names]
        units += reduction.units
        if machine.floating:
            x, z = limb.hip
            collect[:4, links][:, MASS::10] = np.array([1.0, -z, x, x**2 + z**2])[:, None]
            if cumulative:
                collect[3] += collect[columns.start + 2]
    if machine.floating:
        _add_torso(machine, hip, collect, spread)
        if cumulative:
            first = [own + limb.parameters.start + 2 for limb in machine.limbs]
            spread[:, first] -= spread[:, [3]]
    return Reduction(tuple(names), tuple(units), collect, spread)


def _add_torso(machine: PlanarMachine, hip: FloatArray, collect: FloatArray, spread: FloatArray) -> None:
    """Add the torso's own ten parameters, which are about the origin of the root link."""
    # About the hip p its first moment is mc − m p, and its inertia I − 2 (mc · p) + m |p|² within the plane.
    forward, lateral, up = machine.plane
    x, z = forward @ hip, up @ hip
    about_lateral = _quadratic_form(lateral)
    torso, carrier = collect[:4, :10], spread[:10, :4]
    torso[:, MASS] = 1.0, z, -x, x**2 + z**2
    torso[1, MOMENT], torso[2, MOMENT] = -up, forward
    torso[3, MOMENT], torso[3, INERTIA] = -2.0 * (x * forward + z * up), about_lateral
    along = _tensor(lateral)
    carrier[MASS, 0], carrier[MOMENT, 0], carrier[INERTIA, 0] = 1.0, x * forward + z * up, (x**2 + z**2) * along
    carrier[MOMENT, 1], carrier[INERTIA, 1] = -up, -2.0 * z * along
    carrier[MOMENT, 2], carrier[INERTIA, 2] = forward, 2.0 * x * along
    carrier[INERTIA, 3] = along


def _quadratic_form(axis: FloatArray) -> FloatArray:
    """Coefficients of (Ixx, Ixy, Iyy, Ixz, Iyz, Izz) in axisᵀ I axis."""
    x, y, z = axis
    return np.array([x * x, 2 * x * y, y * y, 2 * x * z, 2 * y * z, z * z])


def _tensor(axis: FloatArray) -> FloatArray:
    """Entries (Ixx, Ixy, Iyy, Ixz, Iyz, Izz) of the tensor axis axisᵀ, which has inertia 1 about the axis."""
    x, y, z = axis
    return np.array([x * x, x * y, y * y, x * z, y * z, z * z])
