"""Safety of a law on a microcontroller: what it does when its inputs are old, not finite or absurd."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.joint_numbers import for_joints
from exoid.tools.numbers import checked

SafeTorque = Literal["zero", "damping", "gravity"]
"""Kinds of safe torque; see :class:`Safety`."""


@dataclass(frozen=True, eq=False)
class Safety:
    """Watchdog and safe torque.

    The safe torque replaces the law's while an input is stale, not finite or absurd, or so is the law's torque.

    * "damping" (default): τ = −D v. It only takes energy out of the leg, which sinks slowly. It uses the measured
      velocity only if that is new and finite; otherwise the torque is zero.
    * "zero": τ = 0. The leg falls as fast as its friction allows.
    * "gravity": gravity and springs at the last valid angles, and damping as above. The leg stays where it is, if the
      model is right and the leg does not move far while its angles are unknown. Only for laws with a model.

    Attributes:
        safe: Kind of the safe torque.
        damping: Damping D [N·m·s/rad], a number or (n,); None for the law's own choice.
        patience: Longest time for which the counter of an input may stand still [s].

    Raises:
        ExoidError: There is no such kind, a damping is negative, or the patience is not positive and finite.
    """

    safe: SafeTorque = "damping"
    damping: ArrayLike | None = None
    patience: float = 0.05  # five samples of document 2's controller

    def __post_init__(self) -> None:
        """Check the settings."""
        if self.safe not in get_args(SafeTorque):
            raise BadArgumentError(f"no safe torque {self.safe!r}", remedy=f"use {', '.join(get_args(SafeTorque))}")
        checked(self.patience, "the patience [s]", above=0.0, ndim=0)
        if self.damping is not None:
            object.__setattr__(self, "damping", checked(self.damping, "damping [N·m·s/rad]", least=0.0))

    def steps(self, rate: float) -> int:
        """Convert the patience.

        Args:
            rate: Sampling rate [Hz].

        Returns:
            Number of samples for which a counter may stand still, at least one.
        """
        return max(1, round(self.patience * rate))  # with zero the first sample after a new one would be stale

    def gains(self, default: FloatArray) -> FloatArray:
        """Choose the damping of each joint.

        Args:
            default: Damping of the law [N·m·s/rad], (n,).

        Returns:
            Damping [N·m·s/rad], (n,); zero if the safe torque has none.

        Raises:
            ExoidError: The damping is for another number of joints.
        """
        if self.safe == "zero":
            return np.zeros_like(default)
        return default if self.damping is None else for_joints(self.damping, len(default), "damping")

    def describe(self, default: FloatArray) -> str:
        """Say in one line what the safe torque is.

        Args:
            default: Damping of the law [N·m·s/rad], (n,).

        Returns:
            The line.
        """
        damping = self.gains(default)
        numbers = ", ".join(f"{value:.4g}" for value in damping)
        damped = f"damping of {numbers} N m s/rad while the velocity is known, otherwise zero" if damping.any() else ""
        if self.safe == "gravity":
            return "gravity and springs at the last valid angles" + (f", and {damped}" if damped else "")
        return damped or "zero"
