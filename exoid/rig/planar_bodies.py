"""Rigid-body dynamics of many planar legs at once: mass matrix and bias torque in array operations.

With φ = S q + pitch the absolute angles, d_i the vector along segment i and h_j = Y_j − i X_j its mass moment at the
zero pose (`exoid.leg.reduction.planar`), the kinetic energy is ½ Σ M_ij φ̇_i φ̇_j and the potential g Σ Im H_j, where

    H_j = h_j e^{iφ_j},      M_jj = J_j,      M_ij = Re C_ij,      C_ij = conj(d_i) h_j e^{i(φ_j − φ_i)}  for i < j,

so that the torque on segment i is g Re H_i − Σ Im C_ij φ̇_j² over the segments below, plus Σ Im C_ji φ̇_j² over the
segments above. Each H and C is a phasor, whose phase is linear in q. Mass matrix and bias of the joints, Sᵀ M S and Sᵀ
times the torque, are linear in the phasors: one small matrix product computes all sums.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.leg.leg import Leg
from exoid.leg.reduction.planar import GRAVITY


class PlanarBodies(NamedTuple):
    """Geometry and parameters of B planar legs of n joints, with the K = n + n(n−1)/2 phasors g H_j and C_ij."""

    halves: FloatArray  # matrix from joint angles to half the phases, (K, n)
    half_phases: FloatArray  # half phases at the zero pose, torso pitch included [rad], (K, B)
    lengths: FloatArray  # magnitudes |g H_j| [N·m] and |C_ij| [kg·m²], (K, B)
    rates: FloatArray  # matrix from joint velocities to φ̇_j, then φ̇_i, of each pair, (n(n−1), n)
    sums: FloatArray  # matrix from Re H, Re C, Im C φ̇_j², Im C φ̇_i² to mass matrix and bias, (n² + n, n + 3 n(n−1)/2)
    inertia: FloatArray  # part of the mass matrix that does not depend on the pose [kg·m²], (n², B)

    @classmethod
    def from_parameters(cls, leg: Leg, parameters: FloatArray, pitch: FloatArray) -> PlanarBodies:
        """Compute the phasors of B legs."""
        chain = leg.chain
        assert chain is not None
        X, Y, J = parameters[0::3], parameters[1::3], parameters[2::3].copy()
        if leg.cumulative:
            J[:-1] -= J[1:]
        upper, lower = np.triu_indices(chain.n, 1)  # segments i < j of each pair
        moments = Y - 1j * X
        along = (chain.offsets[:, 0] - 1j * chain.offsets[:, 1])[upper, None]
        phasors = np.concatenate([GRAVITY * moments, along * moments[lower]])
        phases = np.angle(phasors)
        phases[: chain.n] += pitch
        S = np.tril(np.tile(chain.signs, (chain.n, 1)))
        n, pairs, of_upper, of_lower = chain.n, len(upper), S[upper], S[lower]  # how joints turn segments of a pair
        sums = np.zeros((n * n + n, n + 3 * pairs))
        couplings = of_upper[:, :, None] * of_lower[:, None] + of_lower[:, :, None] * of_upper[:, None]
        sums[: n * n, n : n + pairs] = couplings.reshape(pairs, n * n).T
        sums[n * n :] = np.concatenate([S, np.zeros_like(of_upper), -of_upper, of_lower]).T
        return cls(
            halves=0.5 * np.concatenate([S, of_lower - of_upper]),
            half_phases=0.5 * phases,
            lengths=np.abs(phasors),
            rates=np.concatenate([of_lower, of_upper]),
            sums=sums,
            inertia=np.einsum("ka,kb,kr->abr", S, S, J).reshape(-1, J.shape[1]),
        )

    def dynamics(self, q: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Compute mass matrix and bias torque."""
        n, kinds = len(q), len(self.lengths)
        half = self.halves @ q
        half += self.half_phases
        t = np.tan(half, out=half)
        double = t * t
        double += 1.0
        np.divide(self.lengths, double, out=double)
        double += double  # 2 |C| / (1 + t²), as cos φ = 2/(1 + t²) − 1 and sin φ = 2t/(1 + t²)
        terms = np.empty((self.sums.shape[1], q.shape[1]))
        np.subtract(double, self.lengths, out=terms[:kinds])
        squared = self.rates @ v
        squared *= squared
        turning = t[n:] * double[n:]
        shape = (2, *turning.shape)
        np.multiply(squared.reshape(shape), turning, out=terms[kinds:].reshape(shape))
        result = self.sums @ terms
        M = result[: n * n]
        M += self.inertia
        return M.reshape(n, n, -1), result[n * n :]

    def energy(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """Compute kinetic plus potential energy."""
        n = len(q)
        M, _ = self.dynamics(q, v)
        height = self.lengths[:n] * np.sin(2.0 * (self.halves[:n] @ q + self.half_phases[:n]))
        return np.asarray(0.5 * ((M * v).sum(axis=1) * v).sum(axis=0) + height.sum(axis=0))
