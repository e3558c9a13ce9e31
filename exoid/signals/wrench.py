"""Wrench: force and moment that the surroundings exert on a link during a recording."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from exoid._typing import ArrayLike, BoolArray, FloatArray
from exoid.errors import BadArgumentError

from . import checks, timebase
from .sampled import Sampled, means
from .source_location import SourceLocation
from .wrench_checks import refuse_wrong_units

WRENCH_PARTS = ("fx", "fy", "fz", "mx", "my", "mz")
"""Components of a wrench: force [N] and moment [N·m]."""

AXES = ("link", "world")
"""Axes that the vectors of a wrench may have."""


@dataclass(frozen=True, eq=False, repr=False)
class Wrench(Sampled):
    """Force and moment that the surroundings (ground, hand rail, harness) exert on a link, at each sample.

    Both act on the leg: a standing wearer has an upward ground force. The moment is about ``point``; about another
    point p' it is

        m' = m + (p − p') × f.

    Arrays are copied and read-only.

    Attributes:
        force: Force f on the leg [N], (N, 3).
        moment: Moment m about the point [N·m], (N, 3).
        point: Point p that the moment is about [m], (3,); for ``axes="world"`` also one for each sample, (N, 3).
        axes: Axes of force, moment and point. "link": axes and origin of the URDF link. "world": the laboratory, whose
            z axis points up. They need the pose of the base; on a fixed base the laboratory is the root link.

    Raises:
        ExoidError: Shapes do not fit, a number is missing, the axes are unknown, or units look wrong.

    Example:
        >>> Wrench(np.tile([0.0, 0.0, 400.0], (100, 1)), np.zeros((100, 3)), point=(0.05, 0.0, -0.08))
        Wrench(100 samples, axes of the link, about (0.05, 0, -0.08) m; force up to 400 N)
    """

    force: FloatArray
    moment: FloatArray
    point: FloatArray = (0.0, 0.0, 0.0)  # type: ignore[assignment]  # an array once it is made
    axes: Literal["link", "world"] = "link"

    def __post_init__(self) -> None:
        if self.axes not in AXES:
            raise BadArgumentError(
                f"a wrench in axes {self.axes!r}",
                remedy='give its vectors in the axes of the URDF link (axes="link") or of the laboratory, z up '
                '(axes="world")',
            )
        for name in ("force", "moment", "point"):
            object.__setattr__(self, name, checks.as_numbers(getattr(self, name), f"{name} of a wrench"))
        samples = len(np.atleast_1d(self.force))
        for name in ("force", "moment"):
            checks.refuse_shape(getattr(self, name), (samples, 3), f"{name} of a wrench")
        if self.moving_point and self.axes == "link":
            raise BadArgumentError(
                f"point of a wrench in link axes has shape {self.point.shape}",
                remedy="give one point (3,), and the moment about it: moment + np.cross(points - point, force)",
            )
        checks.refuse_shape(self.point, (samples, 3) if self.moving_point else (3,), "point of a wrench")
        checks.refuse_not_finite(self.columns, WRENCH_PARTS, SourceLocation())
        checks.refuse_not_finite(np.atleast_2d(self.point), ("px", "py", "pz"), SourceLocation())
        refuse_wrong_units(self.force, self.moment, self.point, self.axes)

    @property
    def moving_point(self) -> bool:
        """Whether the point is given for each sample."""
        return self.point.ndim == 2

    @property
    def columns(self) -> FloatArray:
        """Columns in the order of :data:`WRENCH_PARTS`, (N, 6)."""
        return np.hstack([self.force, self.moment])

    def about(self, point: ArrayLike) -> Wrench:
        """Give the same wrench with its moment about another point.

        Args:
            point: The point, in the axes of the wrench [m], (3,); for ``axes="world"`` also (N, 3).

        Returns:
            The wrench.

        Raises:
            ExoidError: The shape does not fit, or a number is missing.
        """
        other = checks.as_numbers(point, "point of a wrench")
        if other.shape not in ((3,), (len(self), 3)):
            checks.refuse_shape(other, (3,), "point of a wrench")
        moment = self.moment + np.cross(self.point - other, self.force)
        return replace(self, moment=moment, point=other)

    def rows(self, rows: slice | BoolArray) -> Wrench:
        """Select samples."""
        point = self.point[rows] if self.moving_point else self.point
        return replace(self, force=self.force[rows], moment=self.moment[rows], point=point)

    def interpolated(self, time: FloatArray, grid: FloatArray, rows: slice | BoolArray = slice(None)) -> Wrench:
        """Interpolate at other time stamps by a monotone cubic (PCHIP), as impacts make wrenches jump."""
        # A point that moves jumps where the foot leaves the ground. The moment is therefore taken about one point
        # before.
        columns = timebase.interpolate(time, self._about_one_point.columns[rows], grid, smooth=False)
        return replace(self._about_one_point, force=columns[:, :3], moment=columns[:, 3:])

    def averaged(self, size: int) -> Wrench:
        """Average neighbouring samples, about one point."""
        columns = means(self._about_one_point.columns, size)
        return replace(self._about_one_point, force=columns[:, :3], moment=columns[:, 3:])

    @property
    def _about_one_point(self) -> Wrench:
        """The same wrench about the mean of a point that moves, weighted by the force."""
        if not self.moving_point:
            return self
        weights = np.linalg.norm(self.force, axis=1)
        return self.about(np.average(self.point, axis=0, weights=weights if weights.any() else None))

    def __len__(self) -> int:
        return len(self.force)

    def __repr__(self) -> str:
        axes = "axes of the link" if self.axes == "link" else "axes of the laboratory"
        point = "a moving point" if self.moving_point else f"({', '.join(f'{x:.4g}' for x in self.point.tolist())}) m"
        largest = np.linalg.norm(self.force, axis=1).max(initial=0.0)
        return f"Wrench({len(self)} samples, {axes}, about {point}; force up to {largest:.4g} N)"
