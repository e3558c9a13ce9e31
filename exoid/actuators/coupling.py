"""Coupling: motors that a differential, a belt or a parallel mechanism connects to several joints, and their terms."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.leg import Leg
from exoid.tools.numbers import checked
from exoid.torques import CouplingFriction, CouplingInertia, Term
from exoid.torques.terms import REVERSAL, SMOOTHING

from .drive import joints_of


@dataclass(frozen=True)
class Coupling:
    """As many motors as joints, coupled by a constant matrix: q = A θ_m, and so τ_m = Aᵀ τ.

    By virtual work τ_mᵀ θ̇_m = τᵀ q̇. The torque of motor k is logged in the column of joint k, ``tm_<joint k>``: a
    current times its torque constant (``tm_roll=current:0.05``). Ratios of gears belong into A.

    Friction and rotors of the motors act on several joints, as the terms of :func:`exoid.actuators.motor_terms`.
    ``identify`` adds them where the caller gives no terms.

    Attributes:
        joints: Names of the joints, (k,).
        matrix: A, with a row for each joint and a column for each motor, (k, k).

    Raises:
        ExoidError: The matrix is not square, singular or not finite, or joints are not named once.

    Example:
        >>> wrist = Coupling(("roll", "pitch"), ((0.5, 0.5), (0.5, -0.5)))  # a differential
        >>> wrist.torque(np.array([[3.0, 1.0]]))
        array([[4., 2.]])
    """

    joints: tuple[str, ...]
    matrix: tuple[tuple[float, ...], ...]

    channel = "motor_torque"
    unit = "N·m"
    needs_velocity = False

    def __post_init__(self) -> None:
        """Check joints and matrix."""
        joints, matrix = self.joints, checked(self.matrix, "the matrix of a coupling", ndim=2)
        named = isinstance(joints, list | tuple) and all(isinstance(name, str) for name in joints)
        if not named or len(joints) < 2 or len(set(joints)) != len(joints):
            what, remedy = f"a coupling of {joints!r}", 'name two or more joints, each once: ("roll", "pitch")'
            raise BadArgumentError(what, remedy=remedy)
        count = len(joints)
        if matrix.shape != (count, count):
            raise BadArgumentError(
                f"the matrix of a coupling of {count} joints has the shape {matrix.shape}",
                remedy="give a row for each joint and a column for each motor: q = A θ_m",
            )
        sizes = np.linalg.svd(matrix, compute_uv=False)
        if not sizes[-1] > 1e-9 * sizes[0]:  # nine digits lost leave seven of the torque
            raise BadArgumentError(
                f"the matrix of the coupling of {', '.join(joints)} is singular",
                remedy="motors must move the joints independently: check its rows",
            )
        object.__setattr__(self, "joints", tuple(joints))
        object.__setattr__(self, "matrix", tuple(map(tuple, matrix.tolist())))

    @cached_property
    def inverse(self) -> FloatArray:
        """A⁻¹, with a row for each motor: θ_m = A⁻¹ q, (k, k)."""
        return np.linalg.inv(np.array(self.matrix))

    @property
    def ratio(self) -> float:
        """Speed of the motors over that of the joints: root mean square of the lengths of the rows of A⁻¹."""
        return float(np.sqrt(np.mean((self.inverse**2).sum(axis=1))))

    def on(self, leg: Leg) -> Coupling:
        """Mount the coupling on a leg.

        Args:
            leg: The leg.

        Returns:
            The coupling with the names of the leg's joints.

        Raises:
            ExoidError: A joint is not the leg's.
        """
        return replace(self, joints=joints_of(leg, self.joints, "a coupling"))

    def torque(self, reading: FloatArray) -> FloatArray:
        """Compute the torques at the joints, τ = A⁻ᵀ τ_m.

        Args:
            reading: Torques of the motors [N·m], (N, k).

        Returns:
            Torques [N·m], (N, k).
        """
        return np.asarray(reading @ self.inverse)

    def command(self, torque: FloatArray) -> FloatArray:
        """Compute the torques of the motors, τ_m = Aᵀ τ.

        Args:
            torque: Requested torques [N·m], (N, k).

        Returns:
            Motor torques [N·m], (N, k).
        """
        return np.asarray(torque @ np.array(self.matrix))


def motor_terms(coupling: Coupling) -> tuple[Term, ...]:
    """Make terms of the motors of a coupling: Coulomb and viscous friction, and rotors.

    Motor k has the angle θ_k = Σ_j (A⁻¹)_kj q_j. Velocities of its Coulomb friction are those of the default terms,
    times :attr:`Coupling.ratio`. A motor that moves one joint alone has none: its friction and rotor are terms of that
    joint.

    Args:
        coupling: The coupling.

    Returns:
        The terms.

    Example:
        >>> from exoid.torques import TorqueModel
        >>> wrist = Coupling(("hip", "knee"), ((0.5, 0.5), (0.5, -0.5)))
        >>> TorqueModel(exoid.load_leg("cuhk"), motor_terms(wrist)).names[6:]
        ('c0_hip_motor', 'd_hip_motor', 'c0_knee_motor', 'd_knee_motor', 'Ia_hip_motor')
    """
    smoothing, reversal_speed = coupling.ratio * SMOOTHING, coupling.ratio * REVERSAL
    frictions, rotors = list[Term](), list[Term]()
    for motor, row in zip(coupling.joints, coupling.inverse, strict=True):
        moved = np.flatnonzero(np.abs(row) > 1e-12 * np.abs(row).max()).tolist()
        if len(moved) < 2:
            continue
        joints, ratios = tuple(coupling.joints[j] for j in moved), tuple(row[moved].tolist())
        name = f"{motor}_motor"
        frictions.append(
            CouplingFriction(
                joints=joints, ratios=ratios, name=name, smoothing=smoothing, reversal_speed=reversal_speed
            )
        )
        rotors.append(CouplingInertia(joints=joints, ratios=ratios, name=name))
    return (*frictions, *rotors)
