"""Motion of the base in its own axes, at each sample: all that joint torques depend on."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError

from .reduction import Plane
from .reduction.planar import GRAVITY, TorsoSamples
from .reduction.tree_regressor import BaseSamples


@dataclass(frozen=True, eq=False, repr=False)
class BaseKinematics:
    """Angular velocity ω, angular acceleration ω̇ and specific force f of the base at N samples, in its own axes."""

    # The base is the root link of the URDF. Joint torques depend on the motion of the base only through ω, ω̇ and
    # f = Rᵀ(p̈ − g), where R and p are its orientation and the position of its origin (Featherstone 2008).
    # Position, heading and linear velocity drop out. A base at rest that stands upright has f = (0, 0, 9.81) m/s².

    angular_velocity: FloatArray  # ω [rad/s], (N, 3)
    angular_acceleration: FloatArray  # ω̇ [rad/s²], (N, 3)
    specific_force: FloatArray  # f at the origin of the root link [m/s²], (N, 3)
    up: FloatArray | None = None  # direction upwards, (N, 3), on which balls on the ground depend; None: along z

    def __post_init__(self) -> None:
        """Check shapes and numbers."""
        given = {field.name: getattr(self, field.name) for field in fields(self)}
        arrays = {name: np.asarray(x, dtype=np.float64) for name, x in given.items() if x is not None}
        shapes = [array.shape for array in arrays.values()]
        if len({*shapes}) > 1 or shapes[0][1:] != (3,):
            raise BadArgumentError(
                f"motion of the base of shapes {', '.join(map(str, shapes))}",
                remedy="pass (N, 3) arrays in the axes of the base",
            )
        if not all(np.isfinite(array).all() for array in arrays.values()):
            raise BadArgumentError("the motion of the base is not finite", remedy="remove the NaN or infinite samples")
        for name, array in arrays.items():
            object.__setattr__(self, name, array)

    def __len__(self) -> int:
        return len(self.angular_velocity)

    def __repr__(self) -> str:
        """Write the size in one line."""
        return f"BaseKinematics({len(self)} samples)"

    def rows(self, rows: slice | NDArray[np.intp]) -> BaseKinematics:
        """Select samples."""
        omega, alpha, force = self.angular_velocity, self.angular_acceleration, self.specific_force
        return BaseKinematics(omega[rows], alpha[rows], force[rows], None if self.up is None else self.up[rows])

    def specific_force_at(self, point: FloatArray) -> FloatArray:
        """Compute the specific force at another point of the base, f + ω̇ × r + ω × (ω × r)."""
        spin = np.cross(self.angular_velocity, np.cross(self.angular_velocity, point))
        return np.asarray(self.specific_force + np.cross(self.angular_acceleration, point) + spin)

    def moved(self, point: FloatArray) -> BaseKinematics:
        """Take the specific force at another point of the base."""
        return replace(self, specific_force=self.specific_force_at(point))

    def in_plane(self, plane: Plane, hip: FloatArray) -> TorsoSamples:
        """Take the part of the motion that lies in the plane of a leg, in axes that turn with the base."""
        # In these axes the pitch is zero, and gravity is part of the acceleration of the hip. The angular velocity and
        # acceleration about −lateral are those of the pitch. What turns the plane itself is left out.
        force = self.specific_force_at(hip)
        return TorsoSamples(
            np.zeros(len(self)),
            -self.angular_velocity @ plane.lateral,
            -self.angular_acceleration @ plane.lateral,
            force @ plane.forward,
            force @ plane.up - GRAVITY,
        )

    def within_plane(self, plane: Plane, hip: FloatArray) -> BaseKinematics:
        """Leave out the part of the motion that turns the plane of a leg or moves it sideways."""
        along = np.outer(plane.lateral, plane.lateral)
        force = self.specific_force_at(hip)
        at_hip = BaseKinematics(self.angular_velocity @ along, self.angular_acceleration @ along, force - force @ along)
        return at_hip.moved(-hip)

    def spatial(self) -> BaseSamples:
        """Write the motion as spatial vectors: velocity (0, ω), acceleration less gravity (f, ω̇)."""
        velocity = np.hstack([np.zeros_like(self.angular_velocity), self.angular_velocity])
        return BaseSamples(velocity, np.hstack([self.specific_force, self.angular_acceleration]))
