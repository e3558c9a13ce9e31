"""Soles: the points of a foot that touch the ground."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError

LARGEST = 2.0
"""Largest distance of a point of a sole from the origin of its link [m]; larger ones are in another unit."""


@dataclass(frozen=True, eq=False)
class Sole:
    """Sole of a foot: small spheres at its corners, whose lowest points lie in one plane while the foot stands.

    Attributes:
        points: Lowest points of the spheres in the axes of the link of the foot, whose z axis points up while the foot
            stands [m], (K, 3). Heel and toe are enough for a machine that moves in a plane.
        radius: Radius of the spheres [m].

    Raises:
        ExoidError: The points are not a (K, 3) array of at least two places in m, or the radius is not positive.
    """

    points: FloatArray
    radius: float = 0.005

    def __post_init__(self) -> None:
        """Check shape and unit."""
        points = np.array(self.points, dtype=np.float64)
        if points.ndim != 2 or points.shape[1:] != (3,) or len(points) < 2 or not (np.abs(points) <= LARGEST).all():
            raise ExoidError(
                f"a sole with points of shape {points.shape}",
                remedy=f"give at least heel and toe in m, (K, 3), at most {LARGEST:g} m from the origin of the link",
            )
        if not 0.0 < self.radius < LARGEST:
            raise ExoidError(f"a sole with spheres of radius {self.radius:g} m", remedy="give a few millimetres, in m")
        points.flags.writeable = False
        object.__setattr__(self, "points", points)

    @classmethod
    def flat(cls, heel: float, toe: float, height: float, *, side: float = 0.0, width: float = 0.0) -> Sole:
        """Make a flat sole that is parallel to the x and y axes of its link.

        Args:
            heel: Position of the heel along x [m].
            toe: Position of the toe along x [m].
            height: Position of the sole along z [m].
            side: Position of the middle of the sole along y [m].
            width: Width along y [m]; 0 for two points instead of four.

        Returns:
            The sole.
        """
        sides = [side] if width == 0.0 else [side - width / 2, side + width / 2]
        return cls(np.array([(x, y, height) for x in (heel, toe) for y in sides]))

    @property
    def centre(self) -> FloatArray:
        """Mean of the points in the axes of the link [m], (3,)."""
        return np.asarray(self.points.mean(axis=0))


BLEEX_SOLES: Mapping[str, Sole] = MappingProxyType(
    {
        "left_foot": Sole.flat(-0.075, 0.13, -0.115, side=-0.1),
        "right_foot": Sole.flat(-0.075, 0.13, -0.115, side=0.1),
    }
)
"""Soles of BLEEX as its URDF draws them, an assumption: the document has no drawing of the foot."""
