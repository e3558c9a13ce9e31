"""Rigid-body dynamics of many planar legs at once: mass matrix and bias torque without a loop over rigs.

With φ the absolute angles, P_i = d_i e^{iφ_i} the vector along segment i and H_j = (Y_j − i X_j) e^{iφ_j} its turned
mass moment, the kinetic energy is ½ Σ J_j φ̇_j² + Σ_{i<j} Re(P̄_i H_j) φ̇_i φ̇_j and the potential g Σ Im H_j; see
:mod:`exoid.reduction.planar`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import ComplexArray, FloatArray
from exoid.errors import ExoidError
from exoid.leg import Leg
from exoid.reduction.planar import GRAVITY, PlanarChain


class PlanarBodies(NamedTuple):
    """Geometry and parameters of B planar legs.

    Attributes:
        signs: Of the axes, (n, 1).
        offsets: d, complex, (n − 1, 1).
        moments: Y − i X, complex, (n, B).
        inertias: J, not cumulative, (n, B).
        pitch: Tilt of the torso [rad], (B,).
    """

    signs: FloatArray
    offsets: ComplexArray
    moments: ComplexArray
    inertias: FloatArray
    pitch: FloatArray

    @classmethod
    def from_parameters(cls, leg: Leg, parameters: FloatArray, pitch: FloatArray) -> PlanarBodies:
        """Read (X1, Y1, J1, …), (3 n, B).

        Raises:
            ExoidError: The leg is not a planar chain.
        """
        chain: PlanarChain | None = leg.chain
        if chain is None:
            raise ExoidError("only planar legs can be simulated side by side", where=leg.description.name)
        X, Y, J = parameters[0::3], parameters[1::3], parameters[2::3].copy()
        if leg.cumulative:
            J[:-1] -= J[1:]
        offsets = (chain.offsets[:, 0] + 1j * chain.offsets[:, 1])[:, None]
        return cls(chain.signs[:, None], offsets, Y - 1j * X, J, pitch)

    def dynamics(self, q: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Mass matrix M(q), (n, n, B), and bias C v + G [N·m], (n, B), from q and v, (n, B)."""
        n = len(q)
        angle, rate = q * self.signs, v * self.signs
        angle[0] += self.pitch
        for j in range(1, n):
            angle[j] += angle[j - 1]
            rate[j] += rate[j - 1]
        direction = _direction(angle)
        turned = self.moments * direction
        M = np.empty((n, n, *q.shape[1:]))
        bias = GRAVITY * turned.real
        squared = rate * rate
        diagonal = np.arange(n)
        M[diagonal, diagonal] = self.inertias
        if n > 1:
            along = np.conjugate(self.offsets * direction[:-1])
            for i in range(n - 1):
                coupling = along[i] * turned[i + 1 :]
                M[i, i + 1 :] = M[i + 1 :, i] = coupling.real
                bias[i] -= (coupling.imag * squared[i + 1 :]).sum(axis=0)
                bias[i + 1 :] += coupling.imag * squared[i]
        for k in range(n - 2, -1, -1):  # a joint carries all segments below it
            M[k] += M[k + 1]
            bias[k] += bias[k + 1]
        for k in range(n - 2, -1, -1):
            M[:, k] += M[:, k + 1]
        for joint in np.flatnonzero(self.signs[:, 0] < 0.0):
            M[joint] *= -1.0
            M[:, joint] *= -1.0
            bias[joint] *= -1.0
        return M, bias

    def energy(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """Kinetic and potential energy [J], (B,)."""
        M, _ = self.dynamics(q, v)
        angle = np.cumsum(q * self.signs, axis=0) + self.pitch
        potential = GRAVITY * (self.moments * np.exp(1j * angle)).imag.sum(axis=0)
        return np.asarray(0.5 * ((M * v).sum(axis=1) * v).sum(axis=0) + potential)


def _direction(angle: FloatArray) -> ComplexArray:
    """e^{iφ} from t = tan(φ/2), faster than sine and cosine."""
    t = np.tan(0.5 * angle)
    double = 2.0 / (1.0 + t * t)
    out = np.empty(angle.shape, dtype=np.complex128)
    np.subtract(double, 1.0, out=out.real)
    np.multiply(double, t, out=out.imag)
    return out
