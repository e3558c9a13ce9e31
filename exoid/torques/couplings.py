"""Couplings: springs, friction and rotors along a coordinate that several joints move together.

Such a coordinate is s = Σ r_j q_j: the stretch of a spring that spans two joints, or the angle of a motor that
drives one joint by way of another. A torque f along s takes the power f ṡ = Σ r_j f q̇_j, so that the torque at joint j
is τ_j = r_j f(s, ṡ, s̈), or τ = Aᵀ f(A q, A q̇, A q̈) with the row A of the ratios.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.tools.numbers import checked

from .motion import JointMotion, LoadedMotion
from .term import Term
from .terms import REVERSAL, SMOOTHING, Armature, reversals


@dataclass(frozen=True, kw_only=True)
class CoordinateTerm(Term):
    """Torque along a coordinate s = Σ r_j q_j of several joints, τ_j = r_j f(s, ṡ, s̈).

    It has one set of parameters for all its joints together, named ``symbol_joint1_joint2``. A subclass writes the
    columns of f in ``fill``, as for one joint whose motion is s, ṡ, s̈. It cannot depend on the load of the joints, and
    has no memory.

    Attributes:
        joints: Names (or labels) of the joints, two or more.
        ratios: Ratio r_j of each joint: change of the coordinate with its angle. With 1 for the joint that counts, the
            parameters are in N·m of that joint.
        name: Name of the coordinate in parameter names, such as "hip_motor"; None for the names of the joints.

    Raises:
        ExoidError: There are not two joints with one finite ratio other than zero for each, or the name is empty.
    """

    ratios: tuple[float, ...]
    name: str | None = None

    def __post_init__(self) -> None:
        """Check joints, ratios and name."""
        ratios, joints = self.ratios, self.joints
        named = isinstance(joints, tuple) and len({*joints}) == len(joints) > 1
        numbers = isinstance(ratios, tuple) and all(isinstance(r, (int, float)) and math.isfinite(r) for r in ratios)
        if not named or not numbers or len(ratios) != len(joints or ()) or 0.0 in ratios:
            raise BadArgumentError(
                f"{type(self).__name__}(joints={joints!r}, ratios={ratios!r})",
                remedy='name two joints or more, each once, and give one finite ratio for each, such as joints=("hip", '
                '"knee"), ratios=(1.0, -0.5); leave out joints that do not move the coordinate',
            )
        if self.name is not None and not (isinstance(self.name, str) and self.name.isidentifier()):
            raise BadArgumentError(f"{type(self).__name__}(name={self.name!r})", remedy='a word, such as "hip_motor"')

    def places(self, names: Sequence[str], labels: Sequence[str]) -> dict[str, tuple[int, ...]]:
        """Find its joints among those of a leg; parameters have the name of the coordinate, or of its joints."""
        super().places(names, labels)  # refuses joints that the leg does not have
        places = tuple((names if joint in names else labels).index(joint) for joint in self.joints or ())
        if len(set(places)) < len(places):
            raise BadArgumentError(f"{type(self).__name__} names a joint twice: {', '.join(self.joints or ())}")
        if self.loaded or self.internal_state is not None:
            what = (
                f"{type(self).__name__} {'depends on the load' if self.loaded else 'has memory'}, which a term of "
                "several joints cannot"
            )
            remedy = "let it depend on positions, velocities and accelerations, or use a term of one joint"
            raise BadArgumentError(what, remedy=remedy)
        return {self.name or "_".join(labels[joint] for joint in places): places}

    def fill_block(self, motion: LoadedMotion, joints: tuple[int, ...], out: FloatArray) -> None:
        """Write the columns r_j f of its joints."""
        ratios, chosen = np.array(self.ratios, dtype=np.float64), list(joints)
        columns = np.zeros((len(out), motion.q.shape[1]))
        q, v, a = (ratios @ x[chosen] for x in (motion.q, motion.v, motion.a))
        self.fill(JointMotion(q, v, a, np.zeros_like(q)), columns)
        np.multiply(columns[:, None], ratios[:, None], out=out)


@dataclass(frozen=True, kw_only=True)
class CouplingSpring(CoordinateTerm):
    """Spring that several joints stretch together, f = k s + preload, such as a biarticular spring over hip and knee.

    Its potential is V = k s²/2 + preload · s. The unstretched spring is at s = −preload / k. Offsets of all its joints
    include the preload.

    Example:
        >>> from exoid.torques import TorqueModel
        >>> spring = CouplingSpring(joints=("hip", "knee"), ratios=(1.0, -0.6))
        >>> TorqueModel(exoid.load_leg("cuhk"), (spring,)).names[-2:]
        ('k_hip_knee', 'preload_hip_knee')
    """

    symbols = ("k", "preload")
    units = ("N·m/rad", "N·m")
    nonnegative = ("k",)

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Write the columns s and 1."""
        out[0], out[1] = motion.q, 1.0


@dataclass(frozen=True, kw_only=True)
class CouplingFriction(CoordinateTerm):
    """Friction of a drive or a joint between links that several joints move, f = c0 tanh(ṡ / smoothing) + d ṡ.

    Attributes:
        smoothing: Velocity ṡ over which the sign changes [rad/s]; 0 for a sharp sign.
        reversal_speed: Velocity ṡ below which the drive may stick where it turns round [rad/s], see
            :class:`exoid.Coulomb`; 0 for never.

    Raises:
        ExoidError: A velocity is negative or not finite, or joints or ratios are wrong.
    """

    smoothing: float = SMOOTHING
    reversal_speed: float = REVERSAL

    symbols = ("c0", "d")
    units = ("N·m", "N·m·s/rad")
    nonnegative = ("c0", "d")
    friction = True

    def __post_init__(self) -> None:
        """Check the settings."""
        super().__post_init__()
        for field in ("smoothing", "reversal_speed"):
            checked(getattr(self, field), f"{field} of CouplingFriction [rad/s]", least=0.0, ndim=0)

    def reversing(self, v: FloatArray) -> NDArray[np.bool_] | None:
        """Select the samples at which the coordinate turns round."""
        return reversals(v @ np.array(self.ratios), self.reversal_speed)

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Write the columns tanh(ṡ / smoothing) and ṡ."""
        if self.smoothing > 0.0:
            with np.errstate(over="ignore"):  # a tiny smoothing: tanh of infinity is 1
                np.tanh(np.divide(motion.v, self.smoothing, out=out[0]), out=out[0])
        else:
            np.sign(motion.v, out=out[0])
        out[1] = motion.v


@dataclass(frozen=True, kw_only=True)
class CouplingInertia(CoordinateTerm, Armature):
    """Rotor of a drive that several joints turn, f = Ia s̈, such as a knee motor on the torso behind a belt.

    It adds Ia AᵀA to the mass matrix. It is zero where torque is measured behind the gear.
    """
