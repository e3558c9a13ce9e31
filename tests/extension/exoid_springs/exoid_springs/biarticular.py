"""A spring over two joints as a term."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid.torques import CoupledTerm


@dataclass(frozen=True, kw_only=True)
class Biarticular(CoupledTerm):
    """Spring from the torso to the shank, over hip and knee: V = k (l(q) − rest)²/2, τ = ∂V/∂q.

    Attributes:
        torso: Attachment on the torso, forward and up from the hip [m].
        shank: Attachment on the shank, forward and up from the knee where the leg hangs straight [m].
        thigh: Distance from hip to knee [m].
        rest: Length of the unstretched spring [m].
    """

    torso: tuple[float, float] = (-0.08, 0.05)
    shank: tuple[float, float] = (-0.05, -0.06)
    thigh: float = 0.4165
    rest: float = 0.35

    symbols = ("kb",)
    units = ("N/m",)
    nonnegative = ("kb",)

    def fill_joints(self, motion, out):
        hip, knee = motion.q.T
        lower = np.exp(1j * (hip - knee)) * complex(*self.shank)  # flexion is positive at both joints
        whole = np.exp(1j * hip) * -1j * self.thigh + lower
        spring = whole - complex(*self.torso)
        length = np.abs(spring)
        pull = (length - self.rest) * np.conj(spring) / length
        out[0, :, 0] = (pull * 1j * whole).real
        out[0, :, 1] = (pull * -1j * lower).real

    def potential(self, q):
        """Energy of a spring of 1 N/m [J], at angles (N, 2)."""
        hip, knee = q.T
        lower = np.exp(1j * (hip - knee)) * complex(*self.shank)
        spring = np.exp(1j * hip) * -1j * self.thigh + lower - complex(*self.torso)
        return (np.abs(spring) - self.rest) ** 2 / 2
