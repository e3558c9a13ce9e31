"""The documents' equations typed out term by term, with their misprints repaired where a comment says so.

They share nothing with the library: neither complex numbers nor regressors nor Pinocchio.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

G = 9.81


class Link(NamedTuple):
    """Mass, position of the centre of mass in its joint frame (c_x, c_z) and inertia about it."""

    m: float
    x: float
    z: float
    inertia: float


def bleex_parameters(thigh: Link, shank: Link, foot: Link, L_t: float, L_s: float) -> dict[str, float]:
    """Eqs. (1)-(9), with L − L_G = −c_z and h_G = c_x on the thigh and shank, L_G = c_x and h_G = c_z on the foot."""
    m_t, m_s, m_f = thigh.m, shank.m, foot.m
    L_Gt, h_Gt = L_t + thigh.z, thigh.x
    L_Gs, h_Gs = L_s + shank.z, shank.x
    L_Gf, h_Gf = foot.x, foot.z
    J3 = foot.inertia + m_f * (h_Gf**2 + L_Gf**2)
    J2 = J3 + shank.inertia + m_s * ((L_s - L_Gs) ** 2 + h_Gs**2) + m_f * L_s**2
    J1 = J2 + thigh.inertia + m_t * ((L_t - L_Gt) ** 2 + h_Gt**2) + m_s * L_t**2 + m_f * L_t**2
    return {
        "X1": m_t * (L_t - L_Gt) + m_s * L_t + m_f * L_t,
        "Y1": m_t * h_Gt,
        "J1": J1,
        "X2": m_s * (L_s - L_Gs) + m_f * L_s,
        "Y2": m_s * h_Gs,
        "J2": J2,
        "X3": -m_f * h_Gf,
        "Y3": m_f * L_Gf,
        "J3": J3,
    }


def bleex_torques(p: Mapping[str, float], L_t: float, L_s: float, q: Array, v: Array, a: Array) -> Array:
    """Eqs. (10)-(12), (N, 3): the θ6 of (11) and (12) is θ2, and (12) has parentheses after g."""
    X1, Y1, J1, X2, Y2, J2, X3, Y3, J3 = (p[k] for k in ("X1", "Y1", "J1", "X2", "Y2", "J2", "X3", "Y3", "J3"))
    t1, t2, t3 = q.T
    w1, w2, w3 = v.T
    a1, a2, a3 = a.T
    t12, t23, t123 = t1 + t2, t2 + t3, t1 + t2 + t3
    w12, w123 = w1 + w2, w1 + w2 + w3
    sin, cos = np.sin, np.cos
    T3 = (
        (J3 + L_s * (X3 * cos(t3) - Y3 * sin(t3)) + L_t * (X3 * cos(t23) - Y3 * sin(t23))) * a1
        + (J3 + L_s * (X3 * cos(t3) - Y3 * sin(t3))) * a2
        + J3 * a3
        + L_t * (X3 * sin(t23) + Y3 * cos(t23)) * w1**2
        + L_s * (X3 * sin(t3) + Y3 * cos(t3)) * w12**2
        + G * (X3 * sin(t123) + Y3 * cos(t123))
    )
    T2 = (
        (
            J2
            + 2 * L_s * (X3 * cos(t3) - Y3 * sin(t3))
            + L_t * (X3 * cos(t23) - Y3 * sin(t23))
            + L_t * (X2 * cos(t2) - Y2 * sin(t2))
        )
        * a1
        + (J2 + 2 * L_s * (X3 * cos(t3) - Y3 * sin(t3))) * a2
        + (J3 + L_s * (X3 * cos(t3) - Y3 * sin(t3))) * a3
        + L_t * (X2 * sin(t2) + Y2 * cos(t2)) * w1**2
        + L_t * (X3 * sin(t23) + Y3 * cos(t23)) * w1**2
        + L_s * (X3 * sin(t3) + Y3 * cos(t3)) * (w12**2 - w123**2)
        + G * (X2 * sin(t12) + Y2 * cos(t12) + X3 * sin(t123) + Y3 * cos(t123))
    )
    T1 = (
        (
            J1
            + 2 * L_s * (X3 * cos(t3) - Y3 * sin(t3))
            + 2 * L_t * (X3 * cos(t23) - Y3 * sin(t23))
            + 2 * L_t * (X2 * cos(t2) - Y2 * sin(t2))
        )
        * a1
        + (
            J2
            + 2 * L_s * (X3 * cos(t3) - Y3 * sin(t3))
            + L_t * (X3 * cos(t23) - Y3 * sin(t23))
            + L_t * (X2 * cos(t2) - Y2 * sin(t2))
        )
        * a2
        + (J3 + L_s * (X3 * cos(t3) - Y3 * sin(t3)) + L_t * (X3 * cos(t23) - Y3 * sin(t23))) * a3
        + L_t * (X2 * sin(t2) + Y2 * cos(t2)) * (w1**2 - w12**2)
        + L_t * (X3 * sin(t23) + Y3 * cos(t23)) * (w1**2 - w123**2)
        + L_s * (X3 * sin(t3) + Y3 * cos(t3)) * (w12**2 - w123**2)
        + G * (X1 * sin(t1) + Y1 * cos(t1) + X2 * sin(t12) + Y2 * cos(t12) + X3 * sin(t123) + Y3 * cos(t123))
    )
    return np.column_stack([T1, T2, T3])


def cuhk_parameters(thigh: Link, shank: Link, L_t: float, L_s: float) -> dict[str, float]:
    """Table I, whose last J_2 must be J_t."""
    m_t, m_s, J_t, J_s = thigh.m, shank.m, thigh.inertia, shank.inertia
    L_Gt, h_Gt = L_t + thigh.z, thigh.x
    L_Gs, h_Gs = L_s + shank.z, shank.x
    J2 = m_s * ((L_s - L_Gs) ** 2 + h_Gs**2) + J_s
    return {
        "X1": m_t * (L_t - L_Gt) + m_s * L_t,
        "Y1": m_t * h_Gt,
        "J1": m_t * ((L_t - L_Gt) ** 2 + h_Gt**2) + m_s * L_t**2 + J_t,
        "X2": m_s * (L_s - L_Gs),
        "Y2": m_s * h_Gs,
        "J2": J2,
    }


def cuhk_equations(thigh: Link, shank: Link, L_t: float, L_s: float, q: Array, v: Array, a: Array) -> Array:
    """Eqs. (7) and (8) without friction, (N, 2).

    Repaired in (7): m_s L_t², the sign of h_Gs, and the bracket, which L_t and (θ̇k − 2 θ̇h) multiply whole; in (8): θ̇h².
    """
    m_t, m_s, J_t, J_s = thigh.m, shank.m, thigh.inertia, shank.inertia
    L_Gt, h_Gt = L_t + thigh.z, thigh.x
    L_Gs, h_Gs = L_s + shank.z, shank.x
    h, k = q.T
    wh, wk = v.T
    ah, ak = a.T
    delta = k - h
    sin, cos = np.sin, np.cos
    tau_h = (
        (
            m_t * ((L_t - L_Gt) ** 2 + h_Gt**2)
            + J_t
            + m_s * L_t**2
            + m_s * ((L_s - L_Gs) ** 2 + h_Gs**2)
            + J_s
            + 2 * L_t * (m_s * (L_s - L_Gs) * cos(k) + m_s * h_Gs * sin(k))
        )
        * ah
        - (m_s * ((L_s - L_Gs) ** 2 + h_Gs**2) + J_s + L_t * (m_s * (L_s - L_Gs) * cos(k) + m_s * h_Gs * sin(k))) * ak
        + L_t * (m_s * (L_s - L_Gs) * sin(k) - m_s * h_Gs * cos(k)) * (wk - 2 * wh) * wk
        + (m_t * (L_t - L_Gt) * sin(h) + m_t * h_Gt * cos(h)) * G
        + (m_s * L_t * sin(h) - m_s * (L_s - L_Gs) * sin(delta) + m_s * h_Gs * cos(delta)) * G
    )
    tau_k = (
        (-m_s * ((L_s - L_Gs) ** 2 + h_Gs**2) - J_s - L_t * (m_s * (L_s - L_Gs) * cos(k) + m_s * h_Gs * sin(k))) * ah
        + (m_s * ((L_s - L_Gs) ** 2 + h_Gs**2) + J_s) * ak
        + L_t * (m_s * (L_s - L_Gs) * sin(k) - m_s * h_Gs * cos(k)) * wh**2
        + (m_s * (L_s - L_Gs) * sin(delta) - m_s * h_Gs * cos(delta)) * G
    )
    return np.column_stack([tau_h, tau_k])


class CuhkMatrices(NamedTuple):
    """M (N, 2, 2), C (N, 2, 2) and G (N, 2) of eqs. (10)-(21)."""

    M: Array
    C: Array
    G: Array

    def torques(self, v: Array, a: Array) -> Array:
        """Eq. (9) without friction."""
        return np.einsum("nij,nj->ni", self.M, a) + np.einsum("nij,nj->ni", self.C, v) + self.G


def cuhk_matrices(p: Mapping[str, float], L_t: float, q: Array, v: Array) -> CuhkMatrices:
    """Eqs. (14)-(21): (21) has no θk of its own, and takes Y2 away."""
    X1, Y1, J1, X2, Y2, J2 = (p[key] for key in ("X1", "Y1", "J1", "X2", "Y2", "J2"))
    h, k = q.T
    wh, wk = v.T
    delta = k - h
    sin, cos = np.sin, np.cos
    M11 = 2 * L_t * (X2 * cos(k) + Y2 * sin(k)) + J1 + J2
    M12 = -L_t * (X2 * cos(k) + Y2 * sin(k)) - J2
    M22 = np.full_like(k, J2)
    C11 = -L_t * (X2 * sin(k) - Y2 * cos(k)) * wk
    C12 = L_t * (X2 * sin(k) - Y2 * cos(k)) * (wk - wh)
    C21 = L_t * (X2 * sin(k) - Y2 * cos(k)) * wh
    G_h = (X1 * sin(h) + Y1 * cos(h) - X2 * sin(delta) + Y2 * cos(delta)) * G
    G_k = (X2 * sin(delta) - Y2 * cos(delta)) * G
    matrix = [np.stack(rows, axis=-1) for rows in ([M11, M12, M12, M22], [C11, C12, C21, np.zeros_like(k)])]
    return CuhkMatrices(*(entries.reshape(-1, 2, 2) for entries in matrix), np.column_stack([G_h, G_k]))
