"""Arrays of a recording and what belongs to them, copied, checked and read-only."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass, field

import numpy as np

from exoid._typing import BoolArray, FloatArray
from exoid.errors import ExoidError
from exoid.leg.payload import Payload, as_payloads
from exoid.leg.torso import TorsoMotion

from . import checks
from .base_checks import refuse_unfit_base
from .base_motion import BaseMotion
from .external import External, as_external, refuse_world_axes_without_pose
from .quantities import OF_SOME_JOINTS, PREFIXES, UNITS
from .source import Source
from .source_location import SourceLocation
from .wrench import Wrench


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
    largest_angle: float = checks.LARGEST_ANGLE
    current: FloatArray | None = None
    force: FloatArray | None = None
    motor_torque: FloatArray | None = None
    motor_angle: FloatArray | None = None
    temperature: FloatArray | None = None
    passive: tuple[str, ...] = ()
    payloads: tuple[Payload, ...] = ()
    computed: tuple[str, ...] = ()
    base: BaseMotion | None = None
    wrenches: Mapping[str, Wrench] = field(default_factory=dict)
    contacts: Mapping[str, BoolArray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._freeze()
        self._check()

    def _freeze(self) -> None:
        if isinstance(self.joint_names, str):
            names = repr(self.joint_names)
            raise ExoidError(f"joint_names is the string {names}", remedy=f"pass joint_names=({names},)")
        object.__setattr__(self, "joint_names", tuple(self.joint_names))
        if self.payloads != ():
            object.__setattr__(self, "payloads", as_payloads(self.payloads))
        for name in ("time", *UNITS):
            values = getattr(self, name)
            if values is not None or name in ("time", "q"):
                object.__setattr__(self, name, checks.as_numbers(values, name))
        for name in OF_SOME_JOINTS:
            values = getattr(self, name)
            if values is not None and values.size and np.isnan(values).all():
                object.__setattr__(self, name, None)
        for name in ("passive", "computed"):
            object.__setattr__(self, name, checks.as_joints(getattr(self, name), self.joint_names, name))
        if self.passive:
            shape = (self.time.size, len(self.joint_names))
            tau = checks.with_zero_torque(self.tau, self.passive, self.joint_names, shape)
            object.__setattr__(self, "tau", tau)
        if self.mask is not None:
            object.__setattr__(self, "mask", checks.as_mask(self.mask))
        external = as_external(self.wrenches, self.contacts, self.time.size, self._file)
        for name, values_by_link in external.items():
            object.__setattr__(self, name, values_by_link)

    def _check(self) -> None:
        where, names, samples = SourceLocation(), self.joint_names, self.time.size
        checks.refuse_names(names)
        if not names:
            raise ExoidError("joint_names is empty", remedy="name each column of q")
        checks.refuse_shape(self.time, (samples,), "time")
        for quantity, values in self._arrays().items():
            checks.refuse_shape(values, (samples, len(names)), quantity)
        checks.refuse_too_few(samples, where)
        if self.mask is not None:
            checks.refuse_shape(self.mask, (samples,), "mask")
        checks.refuse_not_finite(self.time[:, np.newaxis], ("time",), where)
        for quantity, values in self._arrays().items():
            there = ~absent_columns(values) if quantity in OF_SOME_JOINTS else np.ones(len(names), dtype=np.bool_)
            columns = tuple(np.array([f"{PREFIXES.get(quantity, quantity)}_{name}" for name in names])[there].tolist())
            checks.refuse_not_finite(values[:, there], columns, where)
            checks.refuse_absurd(values[:, there], columns, where)
            if quantity == "current":
                checks.refuse_milliamperes(values[:, there], columns, where)
            elif quantity == "temperature":
                checks.refuse_no_celsius(values[:, there], columns, where)
        checks.refuse_time_disorder(self.time, where)
        checks.refuse_degrees(self.q, tuple(f"q_{name}" for name in names), self.largest_angle, where)
        checks.refuse_moving_torso(self.torso)
        if self.base is not None:
            refuse_unfit_base(self.time, self.base, self.torso, self._file)
        refuse_world_axes_without_pose(self.wrenches, self.base is None or self.base.pose is not None, self._file)
        if self.v is not None:
            checks.refuse_velocity_in_other_unit(self.time, self.q, self.v, names, where)

    @property
    def _file(self) -> str:
        """Name of the file, for messages."""
        return self.source.name if self.source else ""

    @property
    def _external(self) -> External:
        return {"wrenches": self.wrenches, "contacts": self.contacts}

    def _arrays(self) -> dict[str, FloatArray]:
        arrays = {name: getattr(self, name) for name in UNITS}
        return {name: values for name, values in arrays.items() if values is not None}


def absent_columns(values: FloatArray) -> BoolArray:
    """Find the columns that are NaN throughout."""
    if not np.isnan(values[:1]).any():
        return np.zeros(values.shape[1], dtype=np.bool_)
    return np.asarray(np.isnan(values).all(axis=0))
