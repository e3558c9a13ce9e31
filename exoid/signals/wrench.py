"""Wrench: force and moment that the surroundings exert on a link, their units and the axes a log has them in."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from exoid._typing import ArrayLike, BoolArray, FloatArray
from exoid.errors import BadArgumentError, ExoidError, UnreadableInputError

from . import checks
from .timebase import Sampled

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
        checks.refuse_not_finite(self.columns, WRENCH_PARTS)
        checks.refuse_not_finite(np.atleast_2d(self.point), ("px", "py", "pz"))
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

    def _changed(self, change: Callable[[FloatArray, bool], FloatArray]) -> Wrench:
        # Impacts make it jump, and so does a point where the foot leaves the ground: the moment is about one point
        columns = change(self.about_one_point.columns, False)
        return replace(self.about_one_point, force=columns[:, :3], moment=columns[:, 3:])

    @property
    def about_one_point(self) -> Wrench:
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


def refuse_wrong_units(force: FloatArray, moment: FloatArray, point: FloatArray, axes: str) -> None:
    """Refuse forces, moments and points of a size that only another unit explains."""
    # The line of a force f with moment m is |f × m| / |f|² from the point. Its median, over the samples with at least
    # half of the largest force, is centimetres on a foot: 1000 times as much in N·mm, or with a force in kN.
    size = np.linalg.norm(force, axis=1)
    largest = float(size.max(initial=0.0))
    if largest > 2e4:  # a runner of 150 kg has 5 kN
        raise UnreadableInputError(
            f"a wrench has a force of {largest:.4g} N in row {int(size.argmax())} (limit 20000 N)",
            remedy="give forces in N; a file's unit is given by exoid.signals.Column(..., unit='mN')",
            command="give its unit: --column wrench_<link>_fz=HEADER:mN, and so for x and y",
        )
    moments = np.linalg.norm(moment, axis=1)
    if moments.max(initial=0.0) > 2e4:  # 1 kN that is 10 m from the origin of the laboratory has 10 kN·m
        raise _moment_error(
            f"a wrench has a moment of {moments.max():.4g} N·m in row {int(moments.argmax())} (limit 20000 N·m)"
        )
    away = np.linalg.norm(np.atleast_2d(point), axis=1).max(initial=0.0)
    farthest = {"link": 5.0, "world": 100.0}[axes]
    if away > farthest:
        raise UnreadableInputError(
            f"the point of a wrench is {away:.4g} m from the origin of its axes (limit {farthest:g} m)",
            remedy="give the point in m",
        )
    if largest < 0.2:  # it has no line: a plate in kN reads at least as much under a wearer
        return
    loaded = size >= 0.5 * largest
    arm = np.linalg.norm(np.cross(force[loaded], moment[loaded]), axis=1) / size[loaded] ** 2
    if (middle := float(np.median(arm))) > 20.0:
        raise _moment_error(
            f"the force of a wrench acts {middle:.4g} m from its point (median), with up to {largest:.4g} N"
        )


def _moment_error(what: str) -> UnreadableInputError:
    return UnreadableInputError(
        f"{what}: moments look like N·mm, or forces like kN",
        remedy="give forces in N and moments in N·m; a file's unit is given by exoid.signals.Column(..., unit='N·mm')",
        command="give their units: --column wrench_<link>_mx=HEADER:N·mm, or --column wrench_<link>_fx=HEADER:kN, and "
        "so for the others",
    )


FORM = "LINK:AXES or LINK:AXES@X,Y,Z, such as left_foot:link@0,0,-0.08 or left_foot:world"


class WrenchFrame(NamedTuple):
    """Axes of a wrench in a log, and the point that its moment is about.

    Attributes:
        axes: "link" for those of the URDF link, "world" for those of the laboratory.
        point: The point [m], (3,); None for the origin, or for columns ``wrench_<link>_px…z``.

    Example:
        >>> WrenchFrame.from_text("world@0.5,0.2,0")
        WrenchFrame(axes='world', point=(0.5, 0.2, 0.0))
    """

    axes: str
    point: tuple[float, ...] | None = None

    @staticmethod
    def from_text(text: str) -> WrenchFrame:
        """Read ``AXES`` or ``AXES@X,Y,Z``.

        Args:
            text: The text.

        Returns:
            The frame.

        Raises:
            ExoidError: The text has another form.
        """
        axes, at, coordinates = (part.strip() for part in text.partition("@"))
        try:
            point = tuple(float(part) for part in coordinates.split(",")) if at else None
        except ValueError:
            point = ()
        if axes not in AXES or (point is not None and len(point) != 3):
            raise BadArgumentError(
                f"{text!r} is no axes and point of a wrench",
                remedy=f"write {' or '.join(AXES)}, and behind it perhaps @X,Y,Z in m",
            )
        return WrenchFrame(axes, point)

    def __str__(self) -> str:
        return self.axes if self.point is None else f"{self.axes}@{','.join(repr(float(x)) for x in self.point)}"


def frame_of_link(text: str) -> tuple[str, WrenchFrame]:
    """Read ``LINK:AXES`` or ``LINK:AXES@X,Y,Z``."""
    link, colon, frame = text.rpartition(":")
    if not colon or not link.strip():
        raise BadArgumentError(f"{text!r} does not say the axes of a wrench", remedy=f"write {FORM}")
    try:
        return link.strip(), WrenchFrame.from_text(frame)
    except ExoidError as error:
        raise BadArgumentError(error.what, remedy=f"write {FORM}") from None
