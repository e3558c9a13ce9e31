"""Arrays of a recording and what belongs to them, copied, checked and read-only."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import KW_ONLY, dataclass, field, fields, replace
from typing import Any, TypeVar

import numpy as np

from exoid._typing import BoolArray, FloatArray
from exoid.errors import NotSupportedError, in_file
from exoid.leg.description import LARGEST_ANGLE
from exoid.leg.payload import Payload, as_payloads
from exoid.leg.torso import TorsoMotion

from . import checks
from .base_checks import refuse_unfit_base
from .base_motion import BaseMotion
from .external import as_external, refuse_world_axes_without_pose
from .quantities import QUANTITIES
from .source import Source
from .wrench import Wrench

R = TypeVar("R", bound="RecordingData")


@dataclass(frozen=True, eq=False, repr=False)
class RecordingData:
    """Fields of a recording; :class:`exoid.Recording` says what they are."""

    time: FloatArray
    q: FloatArray
    v: FloatArray | None = None
    a: FloatArray | None = None
    tau: FloatArray | None = None
    _: KW_ONLY
    joint_names: tuple[str, ...]
    source: Source | None = None
    mask: BoolArray | None = None
    torso: TorsoMotion | None = None
    largest_angle: float = LARGEST_ANGLE
    current: FloatArray | None = None
    force: FloatArray | None = None
    motor_torque: FloatArray | None = None
    motor_angle: FloatArray | None = None
    passive: tuple[str, ...] = ()
    payloads: tuple[Payload, ...] = ()
    computed: tuple[str, ...] = ()
    base: BaseMotion | None = None
    wrenches: Mapping[str, Wrench] = field(default_factory=dict)
    contacts: Mapping[str, BoolArray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        with in_file(self.file_name):
            self._freeze()
            self._check()

    def _freeze(self) -> None:
        joints = checks.as_names(self.joint_names, "joint_names")
        frozen: dict[str, object] = {"joint_names": joints, "time": checks.as_numbers(self.time, "time")}
        for each in QUANTITIES:
            values = getattr(self, each.field)
            if values is not None or each.field == "q":
                numbers = checks.as_numbers(values, each.field)
                frozen[each.field] = None if each.partial and numbers.size and np.isnan(numbers).all() else numbers
        for name in ("passive", "computed"):
            frozen[name] = checks.as_joints(getattr(self, name), joints, name)
        if self.passive:
            frozen["tau"] = checks.with_zero_torque(frozen, (np.size(self.time), len(joints)))
        if self.mask is not None:
            frozen["mask"] = checks.as_mask(self.mask)
        if self.payloads != ():
            frozen["payloads"] = as_payloads(self.payloads)
        for name, value in {**frozen, **as_external(self.wrenches, self.contacts, np.size(self.time))}.items():
            object.__setattr__(self, name, value)

    def _check(self) -> None:
        names, samples = self.joint_names, self.time.size
        checks.refuse_names(names)
        checks.refuse_shape(self.time, (samples,), "time")
        for quantity, values in self._arrays().items():
            checks.refuse_shape(values, (samples, len(names)), quantity)
        checks.refuse_too_few(samples)
        if self.mask is not None:
            checks.refuse_shape(self.mask, (samples,), "mask")
        checks.refuse_not_finite(self.time[:, np.newaxis], ("time",))
        for each in QUANTITIES:
            values = getattr(self, each.field)
            if values is not None:
                there = ~absent_columns(values) if each.partial else np.ones(len(names), dtype=np.bool_)
                columns = [f"{each.prefix}_{name}" for name, is_there in zip(names, there, strict=True) if is_there]
                checks.refuse_not_finite(values[:, there], columns)
                checks.refuse_implausible(each.field, values[:, there], columns)
        checks.refuse_time_disorder(self.time)
        checks.refuse_degrees(self.q, tuple(f"q_{name}" for name in names), self.largest_angle)
        if self.torso is not None and any(  # slices and filters do not apply to its motion
            np.ndim(getattr(self.torso, each.name)) > (each.name == "hip_acceleration") for each in fields(self.torso)
        ):
            raise NotSupportedError(
                "the torso moves during the recording",
                remedy="record its motion by an IMU: Recording(base=BaseMotion.from_imu(...)), or hold it still",
            )
        if self.base is not None:
            touched = not self.contacts or bool(self.wrenches) or any(map(np.any, self.contacts.values()))
            refuse_unfit_base(self.time, self.base, self.torso, touched=touched)
        refuse_world_axes_without_pose(self.wrenches, self.base is None or self.base.pose is not None)
        if self.v is not None:
            checks.refuse_velocity_in_other_unit(self.time, self.q, self.v, names)

    @property
    def file_name(self) -> str:
        """Name of the file, for messages; "" for one made in memory."""
        return self.source.name if self.source else ""

    def _arrays(self) -> dict[str, Any]:
        arrays = {each.field: getattr(self, each.field) for each in QUANTITIES}
        return {name: values for name, values in arrays.items() if values is not None}


def change_samples(
    recording: R,
    arrays: Mapping[str, FloatArray],
    part: Callable[[Any], Any],
    flags: Callable[[BoolArray], BoolArray],
) -> R:
    """Give a recording other samples: arrays by field, and what becomes of base motion and wrenches, and of bools."""
    changed: dict[str, Any] = {
        **arrays,
        "mask": None if recording.mask is None else flags(recording.mask),
        "base": None if recording.base is None else part(recording.base),
        "wrenches": {link: part(wrench) for link, wrench in recording.wrenches.items()},
        "contacts": {link: flags(contact) for link, contact in recording.contacts.items()},
    }
    return replace(recording, **changed)


def absent_columns(values: FloatArray) -> BoolArray:
    """Find the columns that are NaN throughout."""
    if not np.isnan(values[:1]).any():
        return np.zeros(values.shape[1], dtype=np.bool_)
    return np.asarray(np.isnan(values).all(axis=0))
