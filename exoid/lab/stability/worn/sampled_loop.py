"""Closed loop of worn legs and a sampled controller as one matrix, exact for a held torque and whole delays."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray

from .linear_law import LinearLaw
from .linear_leg import LinearLeg
from .linear_wearer import LinearWearer


class HeldLeg(NamedTuple):
    """One sampling period of B worn legs under held torques, x⁺ = A x + B δτ and y = C x."""

    # The state is x = (δq, δv) of the leg, then of the limb.

    A: FloatArray  # state matrices, (B, s, s)
    B: FloatArray  # input matrices, (B, s, n)
    C: FloatArray  # readings (q, v, interaction torque) by state, (3 n, s)

    def take(self, rows: NDArray[np.intp]) -> HeldLeg:
        """Select some legs."""
        return HeldLeg(self.A[rows], self.B[rows], self.C)


def hold(leg: LinearLeg, wearer: LinearWearer | None, period: float) -> HeldLeg:
    """Integrate worn legs exactly over one period of constant torque."""
    count, n, _ = leg.M.shape
    size = 2 * n if wearer is None else 4 * n
    one, inverse = np.eye(n), np.linalg.inv(leg.M)
    C = np.eye(3 * n, size)
    joined = np.zeros((count, size + n, size + n))  # of (x, δτ)
    joined[:, :n, n : 2 * n] = one
    joined[:, n : 2 * n, :n] = -inverse @ leg.K
    joined[:, n : 2 * n, n : 2 * n] = -inverse @ leg.D
    joined[:, n : 2 * n, size:] = inverse
    if wearer is None:
        C[2 * n :] = 0.0
    else:
        limb = np.linalg.inv(wearer.M)
        k, d = np.diag(wearer.stiffness), np.diag(wearer.damping)
        cuffs = np.hstack([-k, -d, k, d])  # δτ_wearer by x
        C[2 * n :] = cuffs
        joined[:, n : 2 * n, :size] += inverse @ cuffs
        joined[:, 2 * n : 3 * n, 3 * n : size] = one
        joined[:, 3 * n : size, 2 * n : 3 * n] = -limb @ wearer.K
        joined[:, 3 * n : size, 3 * n : size] = -limb @ wearer.D
        joined[:, 3 * n : size, :size] -= limb @ cuffs
    held = scipy.linalg.expm(period * joined)
    return HeldLeg(held[:, :size, :size], held[:, :size, size:], C)


def loop_matrices(leg: HeldLeg, law: LinearLaw, delay: int) -> FloatArray:
    """Form the matrix of one period for the state (x_k, y_{k−1}, …, y_{k−d}, m_k)."""
    #     x⁺ = A x + B (F y_{k−d} + H m),      m⁺ = E y_{k−d} + N m
    count, size, n = leg.B.shape
    F, H, E, N = (np.broadcast_to(each, (count, *each.shape[-2:])) for each in law)
    read = slice(None) if F[..., 2 * n :].any() or E[..., 2 * n :].any() else slice(2 * n)  # interaction or not
    F, E, C = F[..., read], E[..., read], leg.C[read]
    width, rank = len(C), N.shape[-1]
    past = size + delay * width
    loop = np.zeros((count, past + rank, past + rank))
    if delay:
        late = slice(past - width, past)
        loop[:, size : size + width, :size] = C
        for k in range(size + width, past):
            loop[:, k, k - width] = 1.0
    else:
        F, E, late = F @ C, E @ C, slice(size)
    loop[:, :size, :size] = leg.A
    loop[:, :size, late] += leg.B @ F
    loop[:, past:, late] += E
    loop[:, :size, past:] = leg.B @ H
    loop[:, past:, past:] = N
    return loop
