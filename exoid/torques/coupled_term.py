"""Coupled term: base class of torques that depend on several joints and act on several joints."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError

from .motion import JointMotion, LoadedMotion
from .term import Term


class JointsMotion(NamedTuple):
    """Motion of the m joints of a coupled term over N consecutive samples, in the order of the term's joints.

    Attributes:
        q: Angles [rad], (N, m).
        v: Velocities [rad/s], (N, m).
        a: Accelerations [rad/s²], (N, m).
    """

    q: FloatArray
    v: FloatArray
    a: FloatArray


@dataclass(frozen=True, kw_only=True)
class CoupledTerm(Term):
    """Torque that depends on the motion of several joints and acts on several: τ_j = Σ_p column_pj · parameter_p.

    It has one set of parameters for all its joints together, named ``symbol_joint1_joint2``. Derive a frozen dataclass
    from it and write :meth:`fill_joints`; for a torque along one coordinate s = Σ r_j q_j derive from
    :class:`exoid.torques.CoordinateTerm` instead. It cannot depend on the load of the joints, and has no memory.

    A conservative term has a potential V(q) with τ_j = ∂V/∂q_j: the torque with which the actuators hold it.

    Attributes:
        joints: Names (or labels) of the joints it couples, two or more, in the order of its columns. At a joint whose
            motion it sees and on which it does not act, its columns stay zero.

    Raises:
        ExoidError: Fewer than two joints are named, or one of them twice.

    Example:
        >>> import numpy as np
        >>> class Twist(CoupledTerm):
        ...     '''Potential V = k sin(q1) sin(q2).'''
        ...     symbols = ("k",)
        ...     units = ("N·m",)
        ...
        ...     def fill_joints(self, motion, out):
        ...         sine, cosine = np.sin(motion.q), np.cos(motion.q)
        ...         out[0, :, 0] = cosine[:, 0] * sine[:, 1]
        ...         out[0, :, 1] = sine[:, 0] * cosine[:, 1]
        >>> from exoid.torques import TorqueModel
        >>> TorqueModel(exoid.load_leg("cuhk"), (Twist(joints=("hip", "knee")),)).names[-1]
        'k_hip_knee'
    """

    def __post_init__(self) -> None:
        """Check the joints."""
        self._refuse_joints()

    @abstractmethod
    def fill_joints(self, motion: JointsMotion, out: FloatArray) -> None:
        """Write the columns of all joints.

        Args:
            motion: Motion of the joints, N samples.
            out: Receives torque per unit parameter, zeroed, (number of symbols, N, m).
        """

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Refuse the motion of one joint."""
        raise BadArgumentError(
            f"{type(self).__name__} needs the motion of {', '.join(self.joints or ())} at once",
            remedy="form its columns through a TorqueModel",
        )

    def places(self, names: Sequence[str], labels: Sequence[str]) -> tuple[tuple[int, ...], ...]:
        """Find its joints among those of a leg."""
        self._refuse_joints()
        self.joint_indices(names, labels)
        places = tuple((names if joint in names else labels).index(joint) for joint in self.joints or ())
        if len(set(places)) < len(places):
            raise BadArgumentError(f"{type(self).__name__} names a joint twice: {', '.join(self.joints or ())}")
        if self.loaded or self.internal_state is not None:
            needs = "depends on the load" if self.loaded else "has memory"
            raise BadArgumentError(
                f"{type(self).__name__} {needs}, which a term of several joints cannot",
                remedy="let it depend on positions, velocities and accelerations, or use a term of one joint",
            )
        return (places,)

    def fill_block(self, motion: LoadedMotion, joints: tuple[int, ...], out: FloatArray) -> None:
        """Write the columns of its joints."""
        chosen = list(joints)
        own = JointsMotion(motion.q[chosen].T, motion.v[chosen].T, motion.a[chosen].T)
        self.fill_joints(own, out.transpose(0, 2, 1))

    def _refuse_joints(self) -> None:
        """Refuse anything but a tuple of several different names."""
        joints = self.joints
        if not isinstance(joints, tuple) or len(joints) < 2 or len({*joints}) < len(joints):
            raise BadArgumentError(
                f"{type(self).__name__}(joints={joints!r})",
                remedy='name the joints that it couples, each once, such as joints=("hip", "knee")',
            )
