"""Drive: what stands between a measured current, force or motor angle and the torque of one joint."""

from __future__ import annotations

import math
from typing import NamedTuple, Protocol

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.leg.leg import Leg


class UnknownConstant(NamedTuple):
    """Constant of a drive that is identified."""

    symbol: str  # symbol; the parameter is called `symbol_joint`
    unit: str  # unit
    start: float  # where a search begins
    lower: float  # smallest value
    upper: float  # largest value
    is_scale: bool = False  # whether the torque is proportional to it at all samples


class Drive(Protocol):
    """Drive of one joint: turns a reading into torque, and a torque into a command.

    Torque is that of the actuator on the joint, positive in the direction of q, as everywhere in exoid.
    """

    @property
    def channel(self) -> str:
        """Quantity of a :class:`exoid.Recording` that it turns into torque, such as "current"."""

    @property
    def unit(self) -> str:
        """Unit of its readings and commands."""

    @property
    def needs_velocity(self) -> bool:
        """Whether torque depends on the direction of motion."""

    def on(self, leg: Leg, joint: str) -> Drive:
        """Mount the drive on a joint of a leg.

        Args:
            leg: The leg.
            joint: Name of the joint.

        Returns:
            The drive with all that it needs of the leg's geometry.

        Raises:
            ExoidError: The drive does not fit the joint.
        """

    def torque(self, reading: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """Compute the torque at the joint.

        Args:
            reading: Readings of :attr:`channel`, (N,).
            q: Joint angles [rad], (N,).
            v: Joint velocities [rad/s], (N,).

        Returns:
            Torques [N·m], (N,).

        Raises:
            ExoidError: The readings cannot be those of this drive.
        """

    def command(self, torque: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """Compute the command that makes a torque at the joint, the inverse of :meth:`torque`.

        Args:
            torque: Requested torques [N·m], (N,).
            q: Joint angles [rad], (N,).
            v: Joint velocities [rad/s], (N,).

        Returns:
            Commands in :attr:`unit`, (N,).

        Raises:
            ExoidError: The drive cannot make this torque.
        """


def refuse_unless(valid: bool, what: str, remedy: str) -> None:
    """Refuse a constant of a drive."""
    if not valid:
        raise ExoidError(what, remedy=remedy)


def is_number(value: object) -> bool:
    """Tell whether a constant is a finite real number."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
