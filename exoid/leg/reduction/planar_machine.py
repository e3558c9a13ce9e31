r"""Planar machine: several planar chains on one torso, and their documented regressor on any base.

Rows of joints are those of each chain (see `planar.py`). The hip of limb l is at d_l in the axes of the torso, counted
from the hip of the first limb, the *hip* of the machine. If the torso turns, that of limb l has the
acceleration p̈ + i d_l e^{iφ_0}(φ̈_0 + i φ̇_0²).

A floating torso adds three rows, in its own axes (φ_0 = 0): the force f = f_x + i f_z on it, and the moment about the
hip. With the total mass M and the mass moment h_0 = Y_0 − i X_0 of the torso, with the mass of each limb at its hip,

    f = M (p̈ + i g) + Σ_j i e^{iφ_j}(φ̈_j + i φ̇_j²) h_j,    j = 0 and all segments,
    moment = Re{h_0 i conj(p̈ + i g)} + J_0 φ̈_0 + Σ_l [s_l1 τ_l1 + Im{conj(d_l) (f_l − M_l (p̈_l + i g))}],

where s_l1 τ_l1 is the moment of limb l about its own hip, f_l its part of the force, and M_l its mass. M_l acts at the
hip of the limb, with h_0 and J_0, so that no further parameter is needed. With ``cumulative``, J_0 contains every J_l1.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.tools.numbers import ROUNDED

from .planar import GRAVITY, PlanarChain, Plane, TorsoSamples, fill_regressor

SIDES = ("left_", "right_")
"""Beginnings of joint names that say on which side a limb is."""

TORSO_PARAMETERS = {"M": "kg", "X0": "kg·m", "Y0": "kg·m", "J0": "kg·m²"}
"""Parameters that a floating torso adds, and their units."""

PLANAR_ROWS = ("base_forward", "base_up", "base_pitch")
"""Rows of a floating torso: force [N] forward and up, moment about the hip [N·m], positive about −lateral."""


@dataclass(frozen=True, eq=False)
class Limb:
    """Planar chain of joints on the torso."""

    chain: PlanarChain  # the geometry
    joints: slice  # place of its joints among all joints
    label: str  # "left" or "right" if its joint names say so, otherwise the name of its first joint; "" if it is alone
    hip: FloatArray  # forward and upward place of its first joint, counted from that of the first limb [m], (2,)

    @property
    def parameters(self) -> slice:
        """Place of its parameters (X, Y, J) among those of all limbs."""
        return slice(3 * self.joints.start, 3 * self.joints.stop)


@dataclass(frozen=True, eq=False)
class PlanarMachine:
    """Limbs on one torso, all in parallel planes."""

    limbs: tuple[Limb, ...]  # the limbs, at least one
    floating: bool = False  # whether the torso floats, with three rows and four parameters before those of the joints

    @property
    def plane(self) -> Plane:
        """Plane of motion."""
        return self.limbs[0].chain.plane

    @property
    def n(self) -> int:
        """Number of joints."""
        return sum(limb.chain.n for limb in self.limbs)

    @classmethod
    def from_model(cls, model: pin.Model, *, floating: bool = False) -> PlanarMachine | None:
        """Read the geometry from a model."""
        first = [j for j in range(1, model.njoints) if model.parents[j] == 0]
        parts = [range(start, stop) for start, stop in pairwise([*first, model.njoints])]
        chains = [PlanarChain.of_joints(model, joints) for joints in parts]
        planes = [chain.plane for chain in chains if chain is not None]
        if not chains or len(planes) < len(chains):
            return None
        if any(np.abs(plane.lateral - planes[0].lateral).max() > ROUNDED for plane in planes):
            return None
        labels = _labels([[model.names[j] for j in joints] for joints in parts])
        in_plane = np.column_stack([planes[0].forward, planes[0].up])
        hips = [model.jointPlacements[joints[0]].translation for joints in parts]
        limbs = (
            Limb(chain, slice(joints[0] - 1, joints[-1]), label, (hip - hips[0]) @ in_plane)
            for chain, joints, label, hip in zip(chains, parts, labels, hips, strict=True)
            if chain is not None
        )
        return cls(tuple(limbs), floating)

    def fill_regressor(
        self,
        q: FloatArray,
        v: FloatArray,
        a: FloatArray,
        out: FloatArray,
        *,
        cumulative: bool,
        torso: TorsoSamples | None = None,
    ) -> None:
        """Write the documented regressor for (X1, Y1, J1, X2, …) of each limb, behind (M, X0, Y0, J0) if it floats."""
        first, b = len(TORSO_PARAMETERS) * self.floating, len(PLANAR_ROWS) * self.floating
        if torso is None and self.floating:
            torso = TorsoSamples(*np.zeros((5, len(q))))
        for limb in self.limbs:
            moved, own = torso, limb.joints
            if torso is not None and limb.hip.any():  # the acceleration of this hip
                turn = np.exp(1j * torso.pitch) * (torso.pitch_acceleration + 1j * torso.pitch_rate**2)
                change = 1j * turn * complex(*limb.hip)
                x, z = torso.hip_acceleration_x + change.real, torso.hip_acceleration_z + change.imag
                moved = torso._replace(hip_acceleration_x=x, hip_acceleration_z=z)
            columns = out[first:][limb.parameters]
            force = columns[:, :2] if self.floating else None
            rows = columns[:, b:][:, own]
            motion = q[:, own], v[:, own], a[:, own]
            fill_regressor(limb.chain, *motion, rows, cumulative=cumulative, torso=moved, force=force)
            if torso is not None and force is not None:
                np.multiply(rows[:, 0], limb.chain.signs[0], out=columns[:, 2])
                if limb.hip.any():
                    columns[:, 2] += limb.hip[0] * force[:, 1] - limb.hip[1] * force[:, 0]
                if cumulative:
                    columns[2, 2] -= torso.pitch_acceleration
        if torso is not None and self.floating:
            _fill_torso(torso, out)


def _labels(names: list[list[str]]) -> list[str]:
    """Label of each limb: its side, otherwise the name of its first joint."""
    if len(names) == 1:
        return [""]
    sides = [[side for side in SIDES if all(name.startswith(side) for name in limb)] for limb in names]
    labels = [side[0].removesuffix("_") if side else limb[0] for side, limb in zip(sides, names, strict=True)]
    return labels if len(set(labels)) == len(labels) else [limb[0] for limb in names]


def _fill_torso(torso: TorsoSamples, out: FloatArray) -> None:
    """Fill the base rows of M, X0, Y0 and J0."""
    M, X0, Y0, J0 = out[:4, :3]
    forward, up = torso.hip_acceleration_x, torso.hip_acceleration_z + GRAVITY
    squared = torso.pitch_rate**2
    M[0], M[1] = forward, up
    X0[0], X0[1], X0[2] = torso.pitch_acceleration, squared, forward
    Y0[0], Y0[1], Y0[2] = -squared, torso.pitch_acceleration, up
    J0[2] = torso.pitch_acceleration
