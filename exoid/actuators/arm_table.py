"""Moment arm of a linear actuator as a measured table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.tools.numbers import checked

from .attachments import MomentArm


@dataclass(frozen=True)
class MomentArmTable(MomentArm):
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

    angle: Sequence[float] | FloatArray
    moment_arm: Sequence[float] | FloatArray

    def __post_init__(self) -> None:
        """Check and freeze."""
        angle, arm = (
            np.atleast_1d(checked(getattr(self, name), f"{name} of a moment arm table"))
            for name in ("angle", "moment_arm")
        )
        object.__setattr__(self, "angle", tuple(angle.tolist()))
        object.__setattr__(self, "moment_arm", tuple(arm.tolist()))
        if len(angle) != len(arm) or len(angle) < 4:  # a cubic spline
            raise BadArgumentError(
                f"a table of {len(angle)} angles and {len(arm)} moment arms",
                remedy="measure the arm at four angles or more",
            )
        for wrong, what, remedy in (
            (not (np.diff(angle) > 0.0).all(), "angles that do not ascend", "sort them, each angle once"),
            (np.abs(angle).max() > 2.0 * np.pi, f"angles up to {np.abs(angle).max():.4g} rad", "give radians"),
            (np.abs(arm).max() > 1.0, f"arms up to {np.abs(arm).max():.4g} m", "give moment arms in m, not mm"),
            (not arm.any(), "no arm but zero", "measure the moment arm dl/dq [m]"),
        ):
            if wrong:
                raise BadArgumentError(f"a moment arm table has {what}", remedy=remedy)

    def arm(self, q: FloatArray) -> FloatArray:
        """Cubic spline through the table; an angle beyond it is refused."""
        return np.asarray(self._spline(self._inside(q)))

    def length(self, q: FloatArray) -> FloatArray:
        """l(q) − l(first angle of the table) = ∫ r dq [m]; an angle beyond the table is refused."""
        return np.asarray(self._spline.antiderivative()(self._inside(q)))

    @cached_property
    def _spline(self) -> scipy.interpolate.CubicSpline:
        return scipy.interpolate.CubicSpline(self.angle, self.moment_arm)

    def _inside(self, q: FloatArray) -> FloatArray:
        low, high = float(q.min(initial=np.inf)), float(q.max(initial=-np.inf))
        noise = 1e-3  # of the encoder [rad], by which angles may be beyond the table
        if low < self.angle[0] - noise or high > self.angle[-1] + noise:
            raise BadArgumentError(
                f"angles from {low:.4g} to {high:.4g} rad, and the moment arm was measured from {self.angle[0]:.4g} to "
                f"{self.angle[-1]:.4g} rad",
                remedy="measure the moment arm over the whole motion, or use less of the recording",
            )
        return np.clip(q, self.angle[0], self.angle[-1])
