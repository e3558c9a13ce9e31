"""Axes and reference point of a wrench in a log, as a line of a file or an option of the command line says them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from exoid.errors import ExoidError

from .wrench import AXES

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
            raise ExoidError(
                f"{text!r} is no axes and point of a wrench",
                remedy=f"write {' or '.join(AXES)}, and behind it perhaps @X,Y,Z in m",
            )
        return WrenchFrame(axes, point)

    def __str__(self) -> str:
        return self.axes if self.point is None else f"{self.axes}@{','.join(repr(float(x)) for x in self.point)}"


def as_frames(frames: Mapping[str, WrenchFrame | str]) -> dict[str, WrenchFrame]:
    """Read the frames that are given as text."""
    return {
        link: WrenchFrame.from_text(frame) if isinstance(frame, str) else WrenchFrame(*frame)
        for link, frame in frames.items()
    }


def frame_of_link(text: str) -> tuple[str, WrenchFrame]:
    """Read ``LINK:AXES`` or ``LINK:AXES@X,Y,Z``."""
    link, colon, frame = text.rpartition(":")
    if not colon or not link.strip():
        raise ExoidError(f"{text!r} does not say the axes of a wrench", remedy=f"write {FORM}")
    try:
        return link.strip(), WrenchFrame.from_text(frame)
    except ExoidError as error:
        raise ExoidError(error.what, remedy=f"write {FORM}") from None
