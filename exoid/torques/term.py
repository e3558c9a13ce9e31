"""What acts on a joint besides rigid-body dynamics: a sum of columns times parameters."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .memory import Memory
from .motion import JointMotion


@dataclass(frozen=True, kw_only=True)
class Term(ABC):
    """A resistance of a joint: τ (actuator) = RNEA(q, v, a) + Σ columns · parameters.

    With this sign every dissipative friction and every restoring spring has positive parameters. (Doc. 1, eq. (13),
    counts torques acting on the joint instead, so its B and C have the opposite sign.)

    A term is the same at every joint it acts on, with parameters of its own at each: parameter ``symbol_joint``.

    Attributes:
        joints: Names (or labels) of the joints it acts on; None for all.
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
        """Symbols of parameters that cannot be negative in nature."""
        return ()

    @property
    def friction(self) -> bool:
        """Whether it is friction, which takes energy out of the motion: what figures draw over velocity."""
        return False

    @property
    def loaded(self) -> bool:
        """Whether it depends on the rigid-body torque of its joint, so that the model is no longer linear."""
        return False

    @property
    def memory(self) -> Memory | None:
        """What it remembers of the motion before a sample; None for a term that depends on the sample alone."""
        return None

    @property
    def shape_symbols(self) -> Mapping[str, tuple[str, str]]:
        """Symbol and unit of each setting that may be :class:`exoid.torques.NonlinearParameter`, by its field."""
        return {}

    @abstractmethod
    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Write the columns of one joint.

        Args:
            motion: Of the joint, N samples.
            out: Receives torque per unit parameter, (number of symbols, N).
        """

    def usable(self, v: FloatArray) -> NDArray[np.bool_]:
        """Say which samples the term can be identified from, given the velocity [rad/s] of one joint, (N,)."""
        return np.ones(len(v), dtype=np.bool_)

    def joint_indices(self, names: Sequence[str], labels: Sequence[str]) -> tuple[int, ...]:
        """Find the joints it acts on among those of a leg.

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
