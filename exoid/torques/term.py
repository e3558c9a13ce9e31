"""Base class of the torques that act on a joint besides rigid-body dynamics: columns times parameters."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .internal_state import InternalState
from .motion import JointMotion


@dataclass(frozen=True, kw_only=True)
class Term(ABC):
    """Resistance of a joint: τ (actuator) = RNEA(q, v, a) + Σ columns · parameters.

    With this sign every dissipative friction and every restoring spring has positive parameters. Doc. 1, eq. (13), uses
    torques that act on the joint instead, so its B and C have the opposite sign.

    A term has the same form at every joint it acts on, and separate parameters ``symbol_joint``.

    Attributes:
        joints: Names (or labels) of the joints it acts on; None for all.

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
    def friction(self) -> bool:
        """Whether it is friction, which dissipates energy; figures show it over velocity."""
        return False

    @property
    def loaded(self) -> bool:
        """Whether it depends on the rigid-body torque of its joint, which makes the model nonlinear."""
        return False

    @property
    def internal_state(self) -> InternalState | None:
        """Internal state, which depends on the motion before a sample; None for a term without memory."""
        return None

    @property
    def nonlinear_symbols(self) -> Mapping[str, tuple[str, str]]:
        """Symbol and unit of each field that may be an :class:`exoid.torques.NonlinearParameter`."""
        return {}

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
            v: Velocity of the joint [rad/s], (N,).

        Returns:
            Whether each sample is usable, (N,).
        """
        return np.ones(len(v), dtype=np.bool_)

    def joint_indices(self, names: Sequence[str], labels: Sequence[str]) -> tuple[int, ...]:
        """Find the joints it acts on among those of a leg.

        Args:
            names: Joints of the leg, (n,).
            labels: Joint names as they occur in parameter names, (n,).

        Returns:
            Indices of the joints, in ascending order.

        Raises:
            ExoidError: A joint is missing.
        """
        if self.joints is None:
            return tuple(range(len(names)))
        known = {**dict(zip(labels, range(len(labels)), strict=True)), **{n: i for i, n in enumerate(names)}}
        missing = [joint for joint in self.joints if joint not in known]
        if missing:
            raise ExoidError(
                f"{type(self).__name__} acts on {', '.join(missing)}, which the leg does not have",
                remedy=f"its joints are {', '.join(names)}",
            )
        return tuple(sorted({known[joint] for joint in self.joints}))
