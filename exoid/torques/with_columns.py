"""Torque models with more columns behind those of their parameters, such as faults of a log or other friction."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.signals import Wrench

from .model import TorqueModel
from .motion import Motion
from .regrouping import Regrouped


class ExtraColumns(Protocol):
    """K columns that stand beside those of a torque model's parameters."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns, (K,)."""

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

    model: TorqueModel  # the torque model, with P parameters
    extras: tuple[ExtraColumns, ...]  # the other columns, K in all

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Joints, (n,)."""
        return self.model.joint_names

    @property
    def joint_labels(self) -> tuple[str, ...]:
        """Joint names as they occur in parameter names, (n,)."""
        return self.model.joint_labels

    @property
    def row_names(self) -> tuple[str, ...]:
        """Rows of the equation, (n,)."""
        return self.model.row_names

    @property
    def row_joints(self) -> tuple[int, ...]:
        """Joint of each row, (n,)."""
        return self.model.row_joints

    @property
    def regrouped(self) -> Sequence[Regrouped]:
        """Parameters that are part of others."""
        return self.model.regrouped

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of parameters, then of the other columns, (P + K,)."""
        return (*self.model.names, *(name for extra in self.extras for name in extra.names))

    @cached_property
    def acting(self) -> NDArray[np.bool_]:
        """Columns that can act on each joint, (n, P + K)."""
        return np.hstack([self.model.acting, *(extra.acting for extra in self.extras)])

    def motion(
        self,
        q: Any,  # noqa: ANN401 - arrays of any kind
        v: Any,  # noqa: ANN401
        a: Any,  # noqa: ANN401
        torso: Any = None,  # noqa: ANN401
        payloads: Sequence[Any] = (),
        computed: NDArray[np.bool_] | None = None,
    ) -> Motion:
        """Gather what the columns of a whole recording depend on."""
        motion = self.model.motion(q, v, a, torso, payloads, computed)
        for extra in self.extras:
            motion = extra.motion(motion)
        return motion

    def columns(self, motion: Motion) -> FloatArray:
        """Form the columns."""
        columns = self.model.columns(motion)
        out = np.zeros((len(self.names), *columns.shape[1:]))
        start = len(columns)
        out[:start] = columns
        for extra in self.extras:
            stop = start + len(extra.names)
            extra.fill(motion, columns, out[start:stop])
            start = stop
        return out

    def regressor(self, q: Any, v: Any, a: Any, torso: Any = None) -> FloatArray:  # noqa: ANN401
        """Form the columns, samples first."""
        return self.columns(self.motion(q, v, a, torso)).transpose(2, 1, 0)

    def select(self, recording: Any, joints: tuple[str, ...]) -> Any:  # noqa: ANN401 - a recording or poses
        """Pick the joints of the leg, with wrenches in axes of their links."""
        return self.model.select(recording, joints)

    def row_torque(self, tau: FloatArray, motion: Motion, wrenches: Mapping[str, Wrench]) -> FloatArray:
        """Form the measured side of the equation."""
        return self.model.row_torque(tau, motion, wrenches)

    def measured_rows(self, measured: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Tell which rows have a measured side."""
        return self.model.measured_rows(measured)

    def usable(self, v: FloatArray) -> NDArray[np.bool_]:
        """Say which samples of which joint may be fitted."""
        return self.model.usable(v)

    def reversing(self, v: FloatArray) -> None:
        """Take no reversal out: other friction, and many faults, differ most where joints turn round."""
