"""Drive: what stands between a measured current, force or motor angle and the torque of one joint."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, ClassVar, NamedTuple

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError, UnreadableInputError
from exoid.leg.leg import Leg
from exoid.tools.numbers import is_number

if TYPE_CHECKING:
    from typing_extensions import Self


class UnknownConstant(NamedTuple):
    """Constant of a drive that is identified."""

    symbol: str  # the parameter is called `symbol_joint`
    field: str  # name in the drive
    unit: str
    start: float  # where a search begins
    lower: float
    upper: float
    is_scale: bool = False  # whether the torque is proportional to it at all samples


class Drive:
    """Drive of one joint: turns a reading into torque, and a torque into a command.

    Torque is that of the actuator on the joint, positive in the direction of q, as everywhere in exoid. A drive of your
    own derives from this class.

    Attributes:
        channel: Quantity of a :class:`exoid.Recording` that it turns into torque, such as "current".
        unit: Unit of its readings and commands.
        needs_velocity: Whether torque depends on the direction of motion.
        constants: Constants that may be unknown.
    """

    channel: ClassVar[str]
    unit: ClassVar[str]
    needs_velocity: bool = False
    constants: ClassVar[tuple[UnknownConstant, ...]] = ()

    def on(self, leg: Leg, joint: str) -> Self:
        """Mount the drive on a joint of a leg.

        Args:
            leg: The leg.
            joint: Name of the joint.

        Returns:
            The drive with all that it needs of the leg's geometry.

        Raises:
            ExoidError: The drive does not fit the joint.
        """
        return self

    def torque(self, reading: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """Compute the torque at the joint.

        Args:
            reading: Readings of :attr:`channel`, (N,).
            q: Joint angles [rad], (N,).
            v: Joint velocities [rad/s], (N,).

        Returns:
            Torques [N·m], (N,).

        Raises:
            ExoidError: The readings cannot be those of this drive, or a constant is not known.
        """
        raise NotImplementedError

    def command(self, torque: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """Compute the command that makes a torque at the joint, the inverse of :meth:`torque`.

        Args:
            torque: Requested torques [N·m], (N,).
            q: Joint angles [rad], (N,).
            v: Joint velocities [rad/s], (N,).

        Returns:
            Commands in :attr:`unit`, within the limits of the drive, (N,).

        Raises:
            ExoidError: The drive cannot make this torque, or a constant is not known.
        """
        raise NotImplementedError

    @property
    def unknown(self) -> tuple[UnknownConstant, ...]:
        """Constants that are not known."""
        return tuple(each for each in self.constants if getattr(self, each.field) is None)

    def sensitivity(self, symbol: str, torque: FloatArray, v: FloatArray) -> FloatArray:
        """Differentiate the torque by a constant while the reading stays.

        Args:
            symbol: Symbol of the constant.
            torque: Torques [N·m], (N,).
            v: Joint velocities [rad/s], (N,).

        Returns:
            Derivative [N·m per unit of the constant], (N,); τ / κ for a constant κ that scales the torque.

        Raises:
            ExoidError: The constant is not known.
        """
        (constant,) = (each for each in self.constants if each.symbol == symbol)
        return torque / self.known(constant.field)

    def known(self, name: str) -> float:
        """Value of a constant that may be unknown.

        Args:
            name: Name of the constant in the drive.

        Returns:
            Its value.

        Raises:
            ExoidError: It is not known.
        """
        value = getattr(self, name)
        if value is None:
            raise BadArgumentError(
                f"{name} of the {type(self).__name__} is not known, so that its {self.channel} is no torque",
                remedy=f"give {name}, such as that of a data sheet; exoid.identify finds it if some recordings have a "
                "payload that was weighed",
            )
        return float(value)


def joints_of(leg: Leg, given: Sequence[str], what: str) -> tuple[str, ...]:
    """Names of the leg's joints that are given by name or label; refuse others."""
    names = {**dict(zip(leg.joint_labels, leg.joint_names, strict=True)), **{n: n for n in leg.joint_names}}
    missing = [name for name in given if name not in names]
    if missing:
        what = f"{what} of {', '.join(missing)}, which the leg does not have"
        raise BadArgumentError(what, remedy=f"its joints are {', '.join(leg.joint_names)}")
    return tuple(names[name] for name in given)


def check_constant(
    drive: object, name: str, valid: Callable[[float], bool], remedy: str, *, optional: bool = True
) -> None:
    """Refuse a constant of a drive that is no finite number, or not a valid one."""
    value = getattr(drive, name)
    if not (optional and value is None) and not (is_number(value) and valid(value)):
        raise BadArgumentError(f"{type(drive).__name__}({name}={value!r})", remedy=remedy)


def refuse_beyond(drive: Drive, name: str, reading: FloatArray, remedy: str) -> None:
    """Refuse readings far beyond the largest that a drive can have, its constant of that name: their unit is wrong."""
    limit = getattr(drive, name)
    largest = float(abs(reading).max(initial=0.0))
    # Readings up to this many times the largest are believed: a controller may overshoot for an instant
    if limit is not None and largest > 1.2 * limit:
        raise UnreadableInputError(
            f"a {drive.channel} of {largest:.4g} {drive.unit}, and {name} of the drive is {limit:g} {drive.unit}",
            remedy=remedy,
        )
