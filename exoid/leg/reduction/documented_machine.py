"""Documented reduction of a planar machine: (X, Y, J) of each limb, and M, X0, Y0, J0 of a floating torso."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray

from .documented import INERTIA, MASS, MOMENT, documented, quadratic_form, tensor
from .planar_machine import TORSO_PARAMETERS, PlanarMachine
from .reduction import Reduction


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
    about_lateral = quadratic_form(lateral)
    torso, carrier = collect[:4, :10], spread[:10, :4]
    torso[:, MASS] = 1.0, z, -x, x**2 + z**2
    torso[1, MOMENT], torso[2, MOMENT] = -up, forward
    torso[3, MOMENT], torso[3, INERTIA] = -2.0 * (x * forward + z * up), about_lateral
    along = tensor(lateral)
    carrier[MASS, 0], carrier[MOMENT, 0], carrier[INERTIA, 0] = 1.0, x * forward + z * up, (x**2 + z**2) * along
    carrier[MOMENT, 1], carrier[INERTIA, 1] = -up, -2.0 * z * along
    carrier[MOMENT, 2], carrier[INERTIA, 2] = forward, 2.0 * x * along
    carrier[INERTIA, 3] = along
