"""What a regression asks of a torque model: columns of parameters for a motion, nothing of the leg behind it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray


class Regrouping(Protocol):
    """A parameter that is part of others, whatever the motion."""

    @property
    def name(self) -> str:
        """Name of the parameter."""

    @property
    def into(self) -> Mapping[str, float]:
        """Names of the parameters that contain it, with its share in each."""


class MotionSamples(Protocol):
    """Motion that columns are formed from, (N, n) arrays and hidden states."""

    @property
    def q(self) -> FloatArray:
        """Angles [rad], (N, n)."""

    @property
    def v(self) -> FloatArray:
        """Velocities [rad/s], (N, n)."""

    @property
    def a(self) -> FloatArray:
        """Accelerations [rad/s²], (N, n)."""

    @property
    def payload(self) -> FloatArray | None:
        """Torque that payloads take [N·m], (N, n); None without payloads."""

    def rows(self, rows: slice) -> Any:  # noqa: ANN401 - of the same kind
        """Some of the samples."""


class RegressorModel(Protocol):
    """τ = W(q, v, a) β: the part of :class:`exoid.torques.TorqueModel` that a regression needs."""

    @property
    def names(self) -> tuple[str, ...]:
        """Parameters, in the order of the columns, (P,)."""

    @property
    def acting(self) -> NDArray[np.bool_]:
        """Which columns can act on which joint, (n, P)."""

    def columns(self, motion: Any) -> FloatArray:  # noqa: ANN401 - as a torque model's `motion` returns it
        """Columns of all parameters, and of torque that is known, (P or more, n, N)."""

    @property
    def row_joints(self) -> tuple[int, ...]:
        """Joint of each row, (n,); −1 for a row of no joint."""

    @property
    def regrouped(self) -> Sequence[Regrouping]:
        """Parameters that are part of others."""

    def motion(self, *samples: Any, **beside: Any) -> Any:  # noqa: ANN401 - arrays of any kind
        """Gather q, v, a, motion of the base, payloads and joints with a drive, for the columns."""

    def regressor(self, *samples: Any, **beside: Any) -> FloatArray:  # noqa: ANN401
        """Columns of all parameters, (N, n, P)."""

    def select(self, recording: Any) -> Any:  # noqa: ANN401 - a recording or poses
        """Pick the joints of the leg, with wrenches in axes of their links."""

    def row_torque(self, tau: FloatArray, motion: Any, wrenches: Mapping[str, Any]) -> FloatArray:  # noqa: ANN401
        """Measured side of the equation: torques of the joints, and measured wrenches on links, (N, n)."""

    def measured_rows(self, measured: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Which rows have a measured side, given the joints that have a measured torque, (n,)."""

    def usable(self, v: FloatArray) -> NDArray[np.bool_]:
        """Which samples of which joint may be fitted, (N, n)."""

    def reversing(self, v: FloatArray) -> NDArray[np.bool_] | None:
        """Which samples of which joint belong to a reversal, (N, n); None for none."""
