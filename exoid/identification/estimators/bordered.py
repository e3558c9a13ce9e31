"""Normal equations of trajectories and parameters: banded in the trajectory, with a border for the parameters."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray

from .trajectory import WIDTH, Trajectory, lower_band


class BorderedRows(NamedTuple):
    """Weighted residuals at each sample, measured less predicted, and the derivatives of what is predicted."""

    torque: FloatArray  # residuals of the torques, (N, n)
    angle: FloatArray  # residuals of the angles, (N, n)
    J: FloatArray  # derivatives of the torques with respect to the 6 n coefficients near the sample, (N, n, 6 n)
    W: FloatArray  # derivatives of the torques with respect to β, (N, n, P)
    angle_weight: FloatArray  # derivatives of the angles are the basis functions times this, (n,)


class ReducedSystem(NamedTuple):
    """What is left for β when the trajectory has been put in that is best for it."""

    # With H_cc, H_cβ, H_ββ the blocks of the normal matrix, c the trajectory's coefficients:

    factor: FloatArray  # banded Cholesky factor of H_cc, lower form
    coupling: FloatArray  # H_cc⁻¹ H_cβ, (K n, P)
    free: FloatArray  # step of c while β stays, H_cc⁻¹ g_c, (K n,)
    matrix: FloatArray  # H_ββ − H_βc H_cc⁻¹ H_cβ, (P, P)
    gradient: FloatArray  # g_β − H_βc H_cc⁻¹ g_c, (P,)

    def solve(self, right: FloatArray) -> FloatArray:
        """H_cc⁻¹ times columns, (K n, m)."""
        return np.asarray(scipy.linalg.cho_solve_banded((self.factor, True), right, check_finite=False))


def eliminate(trajectory: Trajectory, rows: BorderedRows) -> ReducedSystem:
    """Form the normal equations of one recording and eliminate its trajectory."""
    # Products of rows are summed over the samples between two knots, which all see the same 6 n coefficients.
    n, P = rows.torque.shape[1], rows.W.shape[2]
    right = np.concatenate([rows.J, rows.W, rows.torque[..., None]], axis=-1)
    grouped = trajectory.grouped(right)
    grouped = grouped.reshape(len(grouped), -1, right.shape[-1])
    local = grouped[..., : WIDTH * n].transpose(0, 2, 1) @ grouped
    near, angle = trajectory.basis[0], rows.angle * rows.angle_weight
    grouped = trajectory.grouped(np.concatenate([near, angle], axis=1))
    angles = grouped[..., :WIDTH].transpose(0, 2, 1) @ grouped
    for joint in range(n):
        mine = slice(joint, WIDTH * n, n)
        local[:, mine, mine] += rows.angle_weight[joint] ** 2 * angles[..., :WIDTH]
        local[:, mine, -1] += angles[..., WIDTH + joint]
    flat = right.reshape(-1, right.shape[-1])[:, WIDTH * n :]
    corner = flat[:, :P].T @ flat
    border = trajectory.overlap(local[..., WIDTH * n :].reshape(len(local), WIDTH, n, P + 1)).reshape(-1, P + 1)
    factor = scipy.linalg.cholesky_banded(lower_band(local, n), lower=True, overwrite_ab=True, check_finite=False)
    inverse = scipy.linalg.cho_solve_banded((factor, True), border, check_finite=False)
    left = corner - border[:, :P].T @ inverse
    return ReducedSystem(factor, inverse[:, :P], inverse[:, P], 0.5 * (left[:, :P] + left[:, :P].T), left[:, P])
