"""Constants of drives that are identified: torque constants, efficiencies, gains of force channels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from exoid.signals import Recording
from exoid.signals.external import ReadOnlyDict

from .actuators import Actuators
from .drive import UnknownConstant


class DriveConstant(NamedTuple):
    """Unknown constant of the drive of one joint."""

    name: str  # name of the parameter, such as "kt_hip"
    joint: int  # index of the joint
    constant: UnknownConstant  # symbol, unit, start and bounds


def unknown_constants(actuators: Actuators) -> tuple[DriveConstant, ...]:
    """List the constants that are not known, joint by joint."""
    return tuple(
        DriveConstant(f"{each.symbol}_{label}", joint, each)
        for joint, (name, label) in enumerate(zip(actuators.joint_names, actuators.joint_labels, strict=True))
        if name in actuators.drives
        for each in actuators.drives[name].unknown
    )


def with_constants(actuators: Actuators, values: Mapping[str, float]) -> Actuators:
    """Replace unknown constants by values."""
    drives = dict(actuators.drives)
    for name, joint, constant in unknown_constants(actuators):
        if name in values:
            drive = drives[actuators.joint_names[joint]]
            drives[actuators.joint_names[joint]] = replace(drive, **{constant.field: values[name]})  # type: ignore[type-var]
    return replace(actuators, drives=ReadOnlyDict(drives))


def recompute(actuators: Actuators, recording: Recording) -> Recording:
    """Compute the torques that follow from drives again, with other constants."""
    if not recording.computed or recording.tau is None:
        return recording
    old = np.isin(recording.joint_names, recording.computed)
    return actuators.torque(replace(recording, tau=np.where(old, np.nan, recording.tau), computed=()))
