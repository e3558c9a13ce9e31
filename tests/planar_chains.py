"""Random planar chains as URDF text, together with what the documents' parameters of each must be.

Everything a planar leg in a URDF can have is varied: the number of joints and the sign of their axes, offsets in the
plane and beside it, joint frames turned any way, links that hang on a fixed joint, fixed links between two joints,
continuous joints, and the plane itself.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from urdf_text import joint_text, link_text

from exoid import Leg
from exoid.leg.description import Description, describe
from exoid.leg.model import configuration

Array = NDArray[np.float64]

PLANES = {
    "y": np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
    "x": np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
}
"""Forward, lateral and up (rows), by the world axis that the joints turn about."""


@dataclass(frozen=True)
class Body:
    """A rigid body by its point masses, so that it is physical whatever the numbers.

    Attributes:
        masses: [kg], (k,).
        points: Positions in the body's frame [m], (k, 3).
    """

    masses: Array
    points: Array

    @property
    def mass(self) -> float:
        return float(self.masses.sum())

    @property
    def centre(self) -> Array:
        return self.masses @ self.points / self.mass

    @property
    def inertia(self) -> Array:
        """About the centre of mass, in the body's frame, (3, 3)."""
        r = self.points - self.centre
        return np.einsum(
            "k,kij->ij", self.masses, np.einsum("ka,ka,ij->kij", r, r, np.eye(3)) - r[:, :, None] * r[:, None]
        )

    @classmethod
    def random(cls, rng: np.random.Generator) -> Body:
        return cls(rng.uniform(0.05, 1.5, 6), rng.uniform(-0.4, 0.4, (6, 3)))


@dataclass(frozen=True)
class Segment:
    """One moving link, seen from the joint above it.

    Attributes:
        sign: +1 where the axis is −lateral (the documents' positive direction), −1 where it is +lateral.
        offset: Forward, lateral and up, from the joint above to this joint at the zero pose, in the plane's axes [m].
        frame: Orientation of the joint frame in the world at the zero pose, (3, 3).
        body: What the joint carries, in the joint frame.
        attached: A body on a fixed joint of the link, and its placement in the joint frame; or None.
        spacer: Placement of a massless link between the link above and this joint; or None.
        continuous: Whether the joint is continuous.
    """

    sign: int
    offset: Array
    frame: Array
    body: Body
    attached: tuple[pin.SE3, Body] | None = None
    spacer: pin.SE3 | None = None
    continuous: bool = False


@dataclass(frozen=True)
class PlanarURDF:
    """A planar chain.

    Attributes:
        segments: From the torso outwards.
        axis: "x" or "y": the world axis that the joints turn about.
    """

    segments: tuple[Segment, ...]
    axis: str = "y"
    joint_names: tuple[str, ...] = field(default=("hip", "knee", "ankle", "toe", "tip"))

    @property
    def n(self) -> int:
        return len(self.segments)

    @property
    def plane(self) -> Array:
        return PLANES[self.axis]

    @cached_property
    def text(self) -> str:
        parts = ['<robot name="chain">', '<link name="torso"/>']
        link, above = "torso", pin.SE3.Identity()
        for number, segment in enumerate(self.segments):
            name, joint = f"link_{self.joint_names[number]}", self.joint_names[number]
            place = pin.SE3(segment.frame, above.translation + self.plane.T @ segment.offset)
            if segment.spacer is not None:
                parts += [f'<link name="spacer_{joint}"/>']
                parts += [joint_text(f"fixed_{joint}", "fixed", link, f"spacer_{joint}", segment.spacer)]
                link, above = f"spacer_{joint}", above * segment.spacer
            kind = "continuous" if segment.continuous else "revolute"
            axis = segment.frame.T @ (-segment.sign * self.plane[1])
            parts += [link_text(name, segment.body), joint_text(joint, kind, link, name, above.actInv(place), axis)]
            if segment.attached is not None:
                where, body = segment.attached
                parts += [link_text(f"attached_{joint}", body)]
                parts += [joint_text(f"screw_{joint}", "fixed", name, f"attached_{joint}", where)]
            link, above = name, place
        return "\n".join([*parts, "</robot>"])

    @property
    def description(self) -> Description:
        return describe(self.text, name="chain.urdf")

    def leg(self, *, cumulative: bool = True) -> Leg:
        return Leg.from_description(self.description, cumulative=cumulative)

    def parameters(self, *, cumulative: bool = True) -> Array:
        """X, Y, J of each segment, summed over point masses: the docstring of ``documented`` without its matrices."""
        out, mass_below = np.zeros((self.n, 3)), 0.0
        for number in range(self.n - 1, -1, -1):
            segment = self.segments[number]
            bodies = [(pin.SE3.Identity(), segment.body)] + ([segment.attached] if segment.attached else [])
            for where, body in bodies:
                for mass, point in zip(body.masses, body.points, strict=True):
                    x, _, z = self.plane @ segment.frame @ where.act(point)
                    out[number] += mass * np.array([-z, x, x**2 + z**2])
            if number + 1 < self.n:
                x, _, z = self.segments[number + 1].offset
                out[number] += mass_below * np.array([-z, x, x**2 + z**2])
            mass_below += sum(body.mass for _, body in bodies)
        if cumulative:
            out[:, 2] = np.cumsum(out[::-1, 2])[::-1]
        return out.ravel()


def random_segment(rng: np.random.Generator, *, continuous: bool) -> Segment:
    """Draw the structure of a segment, then its numbers."""
    sign, offset = int(rng.choice([-1, 1])), rng.uniform(-0.5, 0.5, 3)
    turned, attached, spaced = (bool(rng.integers(2)) for _ in range(3))
    turns = continuous and bool(rng.integers(2))
    frame = pin.rpy.rpyToMatrix(rng.uniform(-3, 3, 3)) if turned else np.eye(3)
    hung = (_placement(rng), Body.random(rng)) if attached else None
    return Segment(sign, offset, frame, Body.random(rng), hung, _placement(rng) if spaced else None, turns)


def random_chain(
    rng: np.random.Generator, length: int | None = None, *, axis: str | None = None, continuous: bool = False
) -> PlanarURDF:
    """Draw a chain of the given length (1 to 5 where none is given)."""
    n = int(rng.integers(1, 6)) if length is None else length
    segments = tuple(random_segment(rng, continuous=continuous) for _ in range(n))
    return PlanarURDF(segments, axis or str(rng.choice(["x", "y"])))


def random_motion(
    rng: np.random.Generator, n: int, samples: int = 20, *, turns: float = 1.0
) -> tuple[Array, Array, Array]:
    """Angles over so many turns either way, velocities to 5 rad/s, accelerations to 20 rad/s²; (samples, n) each."""
    scale = np.array([2.0 * np.pi * turns, 5.0, 20.0])[:, None, None]
    q, v, a = rng.uniform(-1.0, 1.0, (3, samples, n)) * scale
    return q, v, a


def pinocchios_regressor(model: pin.Model, q: Array, v: Array, a: Array) -> Array:
    """Pinocchio's regressor Y with Y π = RNEA(q, v, a) of configurations q."""
    data, rows = model.createData(), zip(q, v, a, strict=True)
    found = [pin.computeJointTorqueRegressor(model, data, *row).copy() for row in rows]
    return np.reshape(found, (*v.shape, -1))  # Pinocchio's of a single joint is a vector


def joint_torque_regressor(model: pin.Model, q: Array, v: Array, a: Array) -> Array:
    """The same of angles."""
    return pinocchios_regressor(model, configuration(model, q), v, a)


def assert_relative(actual: Array, expected: Array, tolerance: float) -> None:
    """Compare arrays up to a tolerance that is relative to the largest expected entry."""
    np.testing.assert_allclose(actual, expected, rtol=0.0, atol=tolerance * np.abs(expected).max())


def _placement(rng: np.random.Generator) -> pin.SE3:
    return pin.SE3(pin.rpy.rpyToMatrix(rng.uniform(-3, 3, 3)), rng.uniform(-0.2, 0.2, 3))
