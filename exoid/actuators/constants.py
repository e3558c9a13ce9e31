"""Constants of drives that are identified: torque constants, efficiencies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np

from exoid._typing import FloatArray
from exoid.signals import Recording

from .actuators import Actuators
from .drive import Drive, UnknownConstant


@runtime_checkable
class Adjustable(Protocol):
    """Drive with constants that may be unknown, such as :class:`exoid.actuators.Motor`."""

    @property
    def unknown(self) -> tuple[UnknownConstant, ...]:
        """Constants that are not known."""

    def with_constants(self, values: Mapping[str, float]) -> Drive:
        """Replace constants by values.

        Args:
            values: Value by symbol.

        Returns:
            The drive.
        """

    def sensitivity(self, symbol: str, torque: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """Differentiate the torque by a constant while the reading stays.

        Args:
            symbol: Symbol of the constant.
            torque: Torques [N·m], (N,).
            q: Joint angles [rad], (N,).
            v: Joint velocities [rad/s], (N,).

        Returns:
            Derivative, (N,).
        """


class DriveConstant(NamedTuple):
    """Unknown constant of the drive of one joint.

    Attributes:
        name: Name of the parameter, such as "kt_hip".
        joint: Index of the joint.
        constant: Symbol, unit, start and bounds.
    """

    name: str
    joint: int
    constant: UnknownConstant


def unknown_constants(actuators: Actuators) -> tuple[DriveConstant, ...]:
    """List the constants that are not known, joint by joint.

    Args:
        actuators: Drives of a leg.

    Returns:
        The constants.
    """
    found = []
    for joint, (name, label) in enumerate(zip(actuators.joint_names, actuators.joint_labels, strict=True)):
        drive: object = actuators.drives.get(name)
        if isinstance(drive, Adjustable):
            found += [DriveConstant(f"{each.symbol}_{label}", joint, each) for each in drive.unknown]
    return tuple(found)


def with_constants(actuators: Actuators, values: Mapping[str, float]) -> Actuators:
    """Replace unknown constants by values.

    Args:
        actuators: Drives of a leg.
        values: Value of constants by name, such as "kt_hip".

    Returns:
        The drives with these constants.

    Raises:
        ExoidError: A value is impossible.
    """
    drives = dict(actuators.drives)
    for each in unknown_constants(actuators):
        if each.name not in values:
            continue
        joint = actuators.joint_names[each.joint]
        drive = drives[joint]
        assert isinstance(drive, Adjustable)
        drives[joint] = drive.with_constants({each.constant.symbol: values[each.name]})
    return replace(actuators, drives=MappingProxyType(drives))


def at_start(actuators: Actuators) -> Actuators:
    """Give unknown constants the values at which a search begins.

    Args:
        actuators: Drives of a leg.

    Returns:
        The drives with these constants.
    """
    return with_constants(actuators, {each.name: each.constant.start for each in unknown_constants(actuators)})


def recompute(actuators: Actuators, recording: Recording) -> Recording:
    """Compute the torques that follow from drives again, with other constants.

    Args:
        actuators: Drives with these constants.
        recording: Recording with torques of other constants.

    Returns:
        The recording with the new torques; one without computed torques stays as it is.
    """
    if not recording.computed or recording.tau is None:
        return recording
    old = np.isin(recording.joint_names, recording.computed)
    return actuators.torque(replace(recording, tau=np.where(old, np.nan, recording.tau), computed=()))
