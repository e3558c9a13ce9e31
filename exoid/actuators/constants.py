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
        """Replace constants by values."""

    def sensitivity(self, symbol: str, torque: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """Differentiate the torque by a constant while the reading stays."""


class DriveConstant(NamedTuple):
    """Unknown constant of the drive of one joint."""

    name: str  # name of the parameter, such as "kt_hip"
    joint: int  # index of the joint
    constant: UnknownConstant  # symbol, unit, start and bounds


def unknown_constants(actuators: Actuators) -> tuple[DriveConstant, ...]:
    """List the constants that are not known, joint by joint."""
    found = []
    for joint, (name, label) in enumerate(zip(actuators.joint_names, actuators.joint_labels, strict=True)):
        drive: object = actuators.drives.get(name)
        if isinstance(drive, Adjustable):
            found += [DriveConstant(f"{each.symbol}_{label}", joint, each) for each in drive.unknown]
    return tuple(found)


def with_constants(actuators: Actuators, values: Mapping[str, float]) -> Actuators:
    """Replace unknown constants by values."""
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
    """Give unknown constants the values at which a search begins."""
    return with_constants(actuators, {each.name: each.constant.start for each in unknown_constants(actuators)})


def recompute(actuators: Actuators, recording: Recording) -> Recording:
    """Compute the torques that follow from drives again, with other constants."""
    if not recording.computed or recording.tau is None:
        return recording
    old = np.isin(recording.joint_names, recording.computed)
    return actuators.torque(replace(recording, tau=np.where(old, np.nan, recording.tau), computed=()))
