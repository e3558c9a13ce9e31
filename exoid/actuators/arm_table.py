"""Moment arm of a linear actuator as a measured table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError
from exoid.leg.leg import Leg

FEWEST_POINTS = 4
"""Smallest number of angles of a table, for a cubic spline."""

LARGEST_ARM = 1.0
"""Largest plausible moment arm [m]; larger ones are in mm."""

LARGEST_ANGLE = 2.0 * np.pi
"""Largest angle of a table [rad]; larger ones are degrees."""

BEYOND = 1e-3
"""Angles this far beyond the table are noise of the encoder [rad]."""


@dataclass(frozen=True)
class MomentArmTable:
    """Measured moment arms r at some angles, with a cubic spline between them and nothing beyond.

    Attributes:
        angle: Angles [rad], ascending, (K,).
        moment_arm: Moment arms r = dl/dq [m], (K,).

    Raises:
        ExoidError: Angles do not ascend, are degrees, arms are in mm, or there are fewer than four.

    Example:
        >>> table = MomentArmTable((-0.5, 0.0, 0.5, 1.0), (0.04, 0.05, 0.05, 0.04))
        >>> print(f"{table.arm(np.array([0.25]))[0]:.4f} m")
        0.0513 m
    """

    angle: Sequence[float]
    moment_arm: Sequence[float]

    def __post_init__(self) -> None:
        """Check and freeze."""
        columns = {name: _numbers(name, getattr(self, name)) for name in ("angle", "moment_arm")}
        for name, values in columns.items():
            object.__setattr__(self, name, tuple(values.tolist()))
        angle, arm = columns.values()
        if len(angle) != len(arm) or len(angle) < FEWEST_POINTS:
            raise ExoidError(
                f"a table of {len(angle)} angles and {len(arm)} moment arms",
                remedy=f"measure the arm at {FEWEST_POINTS} angles or more",
            )
        if not (np.diff(angle) > 0.0).all():
            raise ExoidError("the angles of a moment arm table do not ascend", remedy="sort them, each angle once")
        if np.abs(angle).max() > LARGEST_ANGLE:
            raise ExoidError(
                f"an angle of {np.abs(angle).max():.4g} rad", remedy="give radians, or angle_deg in a file"
            )
        if np.abs(arm).max() > LARGEST_ARM:
            raise ExoidError(f"a moment arm of {np.abs(arm).max():.4g} m", remedy="give moment arms in m, not mm")
        if not arm.any():
            raise ExoidError("all moment arms of a table are zero", remedy="measure the moment arm dl/dq [m]")

    def on(self, leg: Leg, joint: str) -> MomentArmTable:
        """Mount the table, which needs nothing of the leg.

        Args:
            leg: Not used.
            joint: Not used.

        Returns:
            The same table.
        """
        return self

    def arm(self, q: FloatArray) -> FloatArray:
        """Interpolate the moment arm.

        Args:
            q: Joint angles [rad], (N,).

        Returns:
            Moment arms [m], (N,).

        Raises:
            ExoidError: An angle is beyond the table.
        """
        self._refuse_beyond(q)
        return np.asarray(self._spline(np.clip(q, self.angle[0], self.angle[-1])))

    def length(self, q: FloatArray) -> FloatArray:
        """Integrate the moment arm, l(q) − l(first angle of the table) = ∫ r dq.

        Args:
            q: Joint angles [rad], (N,).

        Returns:
            Change of the length [m], (N,).

        Raises:
            ExoidError: An angle is beyond the table.
        """
        self._refuse_beyond(q)
        return np.asarray(self._spline.antiderivative()(np.clip(q, self.angle[0], self.angle[-1])))

    @cached_property
    def _spline(self) -> scipy.interpolate.CubicSpline:
        return scipy.interpolate.CubicSpline(self.angle, self.moment_arm)

    def _refuse_beyond(self, q: FloatArray) -> None:
        low, high = float(q.min(initial=np.inf)), float(q.max(initial=-np.inf))
        if low < self.angle[0] - BEYOND or high > self.angle[-1] + BEYOND:
            raise ExoidError(
                f"angles from {low:.4g} to {high:.4g} rad, and the moment arm was measured from {self.angle[0]:.4g} to "
                f"{self.angle[-1]:.4g} rad",
                remedy="measure the moment arm over the whole motion, or use less of the recording",
            )


def _numbers(name: str, values: ArrayLike) -> FloatArray:
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ExoidError(f"{name} of a moment arm table is no row of numbers ({error})") from None
    if array.ndim != 1 or not np.isfinite(array).all():
        raise ExoidError(f"{name} of a moment arm table is no row of finite numbers", remedy="give rad and m")
    return array
