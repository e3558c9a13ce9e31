"""Torque models with more columns behind those of their parameters, such as faults of a log or other friction."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.regression.model import MotionSamples

from .model import TorqueModel
from .motion import Motion


class ExtraColumns(Protocol):
    """K columns that stand beside those of a torque model's parameters."""

    @property
    def acting(self) -> NDArray[np.bool_]:
        """Columns that can act on each joint, (n, K)."""

    def motion(self, motion: Motion) -> Motion:
        """Add what the columns depend on besides angles, velocities and accelerations."""

    def fill(self, motion: Motion, columns: FloatArray, out: FloatArray) -> None:
        """Write the columns."""


@dataclass(frozen=True, eq=False)
class WithColumns:
    """Torque model with more columns behind those of its parameters."""

    # Recordings are prepared with the torque model itself: only rows are formed with these columns beside its own.

    model: TorqueModel  # the torque model, with P parameters
    extras: tuple[ExtraColumns, ...]  # the other columns, K in all

    @cached_property
    def acting(self) -> NDArray[np.bool_]:
        """Columns that can act on each joint, (n, P + K)."""
        return np.hstack([self.model.acting, *(extra.acting for extra in self.extras)])

    def with_states(self, motion: MotionSamples) -> Motion:
        """Add to a motion what the columns depend on besides angles, velocities and accelerations."""
        assert isinstance(motion, Motion)
        for extra in self.extras:
            motion = extra.motion(motion)
        return motion

    def columns(self, motion: Motion) -> FloatArray:
        """Form the columns."""
        columns = self.model.columns(motion)
        out = np.zeros((self.acting.shape[1], *columns.shape[1:]))
        own, *others = np.split(out, np.cumsum([len(columns), *(one.acting.shape[1] for one in self.extras)])[:-1])
        own[:] = columns
        for extra, part in zip(self.extras, others, strict=True):
            extra.fill(motion, columns, part)
        return out
