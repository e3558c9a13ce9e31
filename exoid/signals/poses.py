"""Poses: static torques of a leg, one row per pose."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.description import LARGEST_ANGLE
from exoid.leg.payload import Payload, as_payloads
from exoid.leg.torso import TorsoMotion

from . import checks
from .source import Source


@dataclass(frozen=True, eq=False, repr=False)
class Poses:
    """Static measurements of one leg: the torques that hold it in K poses.

    Attributes:
        q: Angles [rad], (K, n).
        tau: Actuator torques [N·m], (K, n).
        joint_names: Names of the n columns.
        torso: Tilt of the torso; None if it is upright.
        source: File of the data; None for arrays made in memory.
        payloads: Payloads that were on the leg.

    Raises:
        ExoidError: Shapes do not fit, a value is not finite, or angles look like degrees.

    Example:
        >>> Poses(q=[[0.1, -0.5], [0.3, -0.2]], tau=[[5.0, 1.2], [9.1, 0.4]], joint_names=("hip", "knee"))
        Poses(2 poses; joints: hip, knee)
    """

    q: FloatArray
    tau: FloatArray
    joint_names: tuple[str, ...]
    torso: TorsoMotion | None = None
    source: Source | None = None
    payloads: tuple[Payload, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "joint_names", checks.as_names(self.joint_names, "joint_names"))
        object.__setattr__(self, "payloads", as_payloads(self.payloads))
        shape = (len(self.q) if np.ndim(self.q) else 0, len(self.joint_names))
        for name in ("q", "tau"):
            array = checks.as_numbers(getattr(self, name), name)
            columns = [f"{name}_{joint}" for joint in self.joint_names]
            checks.refuse_shape(array, shape, name)
            checks.refuse_not_finite(array, columns)
            checks.refuse_implausible(name, array, columns)
            object.__setattr__(self, name, array)
        checks.refuse_degrees(self.q, [f"q_{joint}" for joint in self.joint_names], LARGEST_ANGLE)

    def __len__(self) -> int:
        return len(self.q)

    def __repr__(self) -> str:
        payloads = f"; payloads: {', '.join(map(str, self.payloads))}" if self.payloads else ""
        return f"Poses({len(self)} poses; joints: {', '.join(self.joint_names)}{payloads})"

    @property
    def file_name(self) -> str:
        """Name of the file, for messages; "" for poses made in memory."""
        return self.source.name if self.source else ""

    def take(self, rows: slice) -> Poses:
        """Select poses.

        Args:
            rows: The poses.

        Returns:
            These poses.
        """
        return replace(self, q=self.q[rows], tau=self.tau[rows])

    def select(self, joint_names: tuple[str, ...]) -> Poses:
        """Select joints.

        Args:
            joint_names: Names of the joints, in the new order.

        Returns:
            The poses of these joints.

        Raises:
            ExoidError: A joint is missing.
        """
        missing = [name for name in joint_names if name not in self.joint_names]
        if missing:
            raise BadArgumentError(
                f"no joint {', '.join(missing)} in poses of {', '.join(self.joint_names)}", remedy="rename it"
            )
        columns = [self.joint_names.index(name) for name in joint_names]
        return replace(self, q=self.q[:, columns], tau=self.tau[:, columns], joint_names=joint_names)


@dataclass(frozen=True, eq=False)
class Approaches:
    """Poses reached from below (A⁺, joints moving forwards) and from above (A⁻) (doc. 1, sec. III-C).

    Attributes:
        below: Poses after a motion upwards.
        above: The same poses after a motion downwards.

    Raises:
        ExoidError: They differ in number or joints.
    """

    below: Poses
    above: Poses

    def __post_init__(self) -> None:
        """Check that both are the same poses of the same joints."""
        if self.below.payloads != self.above.payloads:
            raise BadArgumentError(
                "poses from below and from above have different payloads", remedy="measure both with one"
            )
        if self.below.joint_names != self.above.joint_names or len(self.below) != len(self.above):
            raise BadArgumentError(
                f"{len(self.below)} poses of {', '.join(self.below.joint_names)} from below, {len(self.above)} of "
                f"{', '.join(self.above.joint_names)} from above",
                remedy="measure the same poses from both sides",
            )

    @property
    def averaged(self) -> Poses:
        """Mean of both torques, in which static friction cancels if both are within its band."""
        below, above = self.below, self.above
        return replace(below, q=0.5 * (below.q + above.q), tau=0.5 * (below.tau + above.tau))

    @property
    def band(self) -> FloatArray:
        """Half the difference of both torques, ½ (A⁺ − A⁻) [N·m], (K, n): a lower bound of the friction c0."""
        return 0.5 * (self.below.tau - self.above.tau)
