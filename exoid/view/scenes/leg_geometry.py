"""A leg as it stands in a scene: the tree of its bodies and what each of them looks like."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import cycle
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.estimate import Estimate
from exoid.leg import SIDES, Leg
from exoid.lift import lift
from exoid.view.colours import CAD, IDENTIFIED, JOINT_COLOURS

from .bars import bars, mount
from .commands import Command, child, place, show
from .inertias import ball, shell
from .parts import Look, Part, cylinder, moved, towards
from .skeleton import Skeleton
from .visuals import read_visuals


class Inertias(NamedTuple):
    """Inertias of the moving bodies from one source.

    Attributes:
        label: Where they come from.
        colour: Theirs.
        bodies: About the frames of the joints, n of them.
    """

    label: str
    colour: str
    bodies: tuple[pin.Inertia, ...]


@dataclass(frozen=True, eq=False)
class Figure:
    """A leg in a scene.

    Attributes:
        skeleton: Its bodies.
        root: Path of its torso.
        shapes: What each body looks like, the torso first.
        inertias: From one source or two.
        notes: What could not be drawn as asked.
    """

    skeleton: Skeleton
    root: str
    shapes: tuple[tuple[Part, ...], ...]
    inertias: tuple[Inertias, ...]
    notes: tuple[str, ...]

    @classmethod
    def of(cls, drawn: Leg | Estimate, identified: Sequence[Leg], folder: Path | None, above: str) -> Figure:
        """Make one of a leg, or of an estimate with the links nearest to its parameters.

        Args:
            drawn: The leg or estimate.
            identified: Legs with other inertias; that with the same joints counts.
            folder: Where meshes are.
            above: Path that the figure is a child of.
        """
        leg = drawn if isinstance(drawn, Leg) else drawn.model.leg
        skeleton = Skeleton(leg)
        shapes, notes = _shapes(skeleton, folder)
        inertias = [Inertias("CAD", CAD, tuple(leg.model.inertias)[1:])]
        if isinstance(drawn, Estimate):
            inertias.append(Inertias("identified", IDENTIFIED, _lifted(drawn)))
        else:
            others = [other for other in identified if other.joint_names == leg.joint_names]
            inertias += [Inertias("identified", IDENTIFIED, tuple(other.model.inertias)[1:]) for other in others[:1]]
        return cls(skeleton, child(above, _name(leg)), shapes, tuple(inertias), notes)

    @property
    def leg(self) -> Leg:
        """The leg."""
        return self.skeleton.leg

    @property
    def colours(self) -> list[str]:
        """Of the joints."""
        return [colour for colour, _ in zip(cycle(JOINT_COLOURS), self.leg.joint_names, strict=False)]

    def without_torso(self) -> Figure:
        """Return the same without the torso, which another figure draws."""
        return replace(self, shapes=((), *self.shapes[1:]))

    def mounts(self, root: str) -> tuple[str, ...]:
        """Path of each joint's frame, in which its body moves, below a root."""
        paths = [root]
        for name, parent in zip(self.leg.joint_names, self.skeleton.parents, strict=True):
            paths.append(child(paths[parent] if parent == 0 else f"{paths[parent]}/body", name))
        return tuple(paths[1:])

    def frames(self, root: str) -> Iterator[Command]:
        """Commands that put the frames of the joints where they belong."""
        for path, transform in zip(self.mounts(root), self.skeleton.placements, strict=True):
            yield place(path, transform)

    def draw(self, root: str, look: Look | None = None) -> Iterator[tuple[str, Command]]:
        """Paths and commands that draw the bodies, all with one look where that is given."""
        for path, parts in zip([root, *(f"{m}/body" for m in self.mounts(root))], self.shapes, strict=True):
            drawn = [part if look is None else part.looking(look) for part in parts]
            if drawn:
                yield f"{path}/shape", show(f"{path}/shape", drawn, shadows=look is None)

    def draw_axes(self) -> Iterator[tuple[str, Command]]:
        """Paths and commands that draw the axes of the joints."""
        length = 0.3 * self.skeleton.reach
        for path, axis, colour in zip(self.mounts(self.root), self.skeleton.axes, self.colours, strict=True):
            rod = cylinder(0.004 * self.skeleton.reach, length, Look(colour, finish="flat"))
            yield f"{path}/axis", show(f"{path}/axis", [rod.at(moved(np.zeros(3), towards(axis)))], shadows=False)

    def draw_inertias(self, inertias: Inertias, what: str) -> Iterator[tuple[str, Command]]:
        """Paths and commands that draw "mass" or "inertia" from one source."""
        draw = {"mass": ball, "inertia": shell}[what]
        for path, inertia in zip(self.mounts(self.root), inertias.bodies, strict=True):
            where = f"{path}/body/{what} {inertias.label}"
            yield where, show(where, [draw(inertia, inertias.colour)], shadows=False)

    def extent(self, q: FloatArray) -> FloatArray:
        """Points whose hull contains the leg in all poses, (N, n), in the torso's frame, (k, 3)."""
        places = self.skeleton.bodies(q)
        points = [
            np.einsum("fij,kj->fki", places[:, body, :3, :3], corners) + places[:, body, np.newaxis, :3, 3]
            for body, parts in enumerate(self.shapes)
            if parts
            for corners in [np.vstack([part.extent for part in parts])]
        ]
        return np.vstack([each.reshape(-1, 3) for each in points])


def _shapes(skeleton: Skeleton, folder: Path | None) -> tuple[tuple[tuple[Part, ...], ...], tuple[str, ...]]:
    """Shape every body: as the URDF says, else by bars."""
    wanted = [name for links in skeleton.links for name in links]
    parts, notes = read_visuals(skeleton.leg.description, wanted, folder)
    colours = cycle(JOINT_COLOURS)
    shapes = []
    for body, links in enumerate(skeleton.links):
        drawn = [part.at(where) for name, where in links.items() for part in parts.get(name, ())]
        colour = "" if body == 0 else next(colours)
        shapes.append(tuple(drawn or (bars(skeleton, body, colour) if body else mount(skeleton))))
    return tuple(shapes), notes


def _lifted(estimate: Estimate) -> tuple[pin.Inertia, ...]:
    """Inertias that can exist and are nearest to the estimate."""
    leg = estimate.model.leg
    p = len(leg.parameter_names)
    lifted = lift(leg, estimate.values[:p], estimate.covariance[:p, :p])
    return tuple(pin.Inertia.FromDynamicParameters(row) for row in lifted.link_parameters)


def _name(leg: Leg) -> str:
    """Name of a leg: its side, if it has one."""
    for side in SIDES:
        if all(name.startswith(side) for name in leg.joint_names):
            return f"{side.removesuffix('_')} leg"
    return Path(leg.description.name).stem
