"""Term: base class of the torques that act on a joint besides rigid-body dynamics, and its columns."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError

from .motion import JointMotion, LoadedMotion, Motion
from .presliding import Presliding


@dataclass(frozen=True, kw_only=True)
class Term(ABC):
    """Resistance of a joint: τ (actuator) = RNEA(q, v, a) + Σ columns · parameters.

    With this sign every dissipative friction and every restoring spring has positive parameters. Doc. 1, eq. (13), uses
    torques that act on the joint instead, so its B and C have the opposite sign.

    A term has the same form at every joint it acts on, and separate parameters ``symbol_joint``. Settings that differ
    from joint to joint are two terms of one type with other ``joints``. A torque that depends on the motion of several
    joints, or acts on several, is a :class:`exoid.torques.CoordinateTerm`.

    Attributes:
        joints: Names (or labels) of the joints it acts on; None for all.
        friction: Whether it is friction, which dissipates energy; figures show it over velocity.
        loaded: Whether it depends on the rigid-body torque of its joint, which makes the model nonlinear.

    Example:
        >>> class Quadratic(Term):
        ...     @property
        ...     def symbols(self):
        ...         return ("c2",)
        ...
        ...     @property
        ...     def units(self):
        ...         return ("N·m·s²/rad²",)
        ...
        ...     def fill(self, motion, out):
        ...         out[0] = motion.v * np.abs(motion.v)
        >>> from exoid.torques import TorqueModel
        >>> TorqueModel(exoid.load_leg("cuhk"), (Quadratic(joints=("knee",)),)).names[-1]
        'c2_knee'
    """

    joints: tuple[str, ...] | None = None
    friction: ClassVar[bool] = False
    loaded: ClassVar[bool] = False

    @property
    @abstractmethod
    def symbols(self) -> tuple[str, ...]:
        """Symbol of each parameter."""

    @property
    @abstractmethod
    def units(self) -> tuple[str, ...]:
        """Unit of each parameter."""

    @property
    def nonnegative(self) -> tuple[str, ...]:
        """Symbols of the parameters that cannot be negative in nature."""
        return ()

    @property
    def internal_state(self) -> Presliding | None:
        """Internal state, which depends on the motion before a sample; None for a term without memory."""
        return None

    @abstractmethod
    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Write the columns of one joint.

        Args:
            motion: Motion of the joint, N samples.
            out: Receives torque per unit parameter, (number of symbols, N).
        """

    def usable(self, v: FloatArray) -> NDArray[np.bool_]:
        """Select the samples from which the term can be identified.

        Args:
            v: Velocity of the joint [rad/s], (N,); of a coupled term those of its m joints, (N, m).

        Returns:
            Whether each sample is usable, (N,).
        """
        return np.ones(len(v), dtype=np.bool_)

    def reversing(self, v: FloatArray) -> NDArray[np.bool_] | None:
        """Select the samples around reversals, at which the torque of the joint is not that of the term.

        A fit behind the parallel filter takes any torque of the joint at these samples for unknown.

        Args:
            v: Velocity of the joint over a recording [rad/s], (N,); of a coupled term those of its m joints, (N, m).

        Returns:
            Whether each sample belongs to a reversal, (N,); None for none.
        """
        return None

    def places(self, names: Sequence[str], labels: Sequence[str]) -> dict[str, tuple[int, ...]]:
        """Find where it acts in a leg: one set of parameters for each tuple of joints.

        Args:
            names: Joints of the leg, (n,).
            labels: Joint names as they occur in parameter names, (n,).

        Returns:
            Indices of joints by what follows the symbol in parameter names, such as "knee": each joint alone, unless
            the term is a :class:`exoid.torques.CoordinateTerm`.

        Raises:
            ExoidError: A joint is missing.
        """
        known = {**dict(zip(labels, range(len(labels)), strict=True)), **{n: i for i, n in enumerate(names)}}
        missing = [joint for joint in self.joints or () if joint not in known]
        if missing:
            what = f"{type(self).__name__} acts on {', '.join(missing)}, which the leg does not have"
            remedy = f"its joints are {', '.join(names)}"
            raise BadArgumentError(what, remedy=remedy)
        chosen = range(len(names)) if self.joints is None else sorted({known[joint] for joint in self.joints})
        return {labels[joint]: (joint,) for joint in chosen}

    def fill_block(self, motion: LoadedMotion, joints: tuple[int, ...], out: FloatArray) -> None:
        """Write the columns of one set of parameters.

        Args:
            motion: Motion of all joints of the leg, N samples.
            joints: Indices of the joints that the parameters act on, m of them.
            out: Receives the columns, zeroed, (number of symbols, m, N).
        """
        (j,), kind = joints, self.internal_state
        state = None if kind is None else motion.states[j, kind]
        self.fill(JointMotion(motion.q[j], motion.v[j], motion.a[j], motion.load[j], state), out[:, 0])


class TermBlock(NamedTuple):
    """One term at one joint, or at the joints that it couples."""

    term: Term  # the term
    joints: tuple[int, ...]  # indices of the joints
    names: tuple[str, ...]  # names of its parameters, `symbol_joint` or `symbol_joint1_joint2`

    def columns(self, motion: LoadedMotion) -> FloatArray:
        """Form the columns of all its parameters."""
        out = np.zeros((len(self.names), len(self.joints), motion.q.shape[1]))
        self.term.fill_block(motion, self.joints, out)
        return out


def load_motion(blocks: Sequence[TermBlock], motion: Motion, columns: FloatArray, rigid: FloatArray) -> LoadedMotion:
    """Add rigid-body torques to a motion, if a term depends on them; they are zero otherwise."""
    load = np.broadcast_to(0.0, motion.q.shape[::-1])
    payload = load if motion.payload is None else motion.payload.T
    if any(block.term.loaded for block in blocks):
        load = np.tensordot(rigid, columns[: len(rigid)], axes=1) + payload
    return LoadedMotion(motion.q.T, motion.v.T, motion.a.T, load, payload, motion.states)
